// The curves and fixed points around which streamlines are placed first: periodic orbits, separatrices and fixed points
// of a field (thesis 3.4).
//
//   const StreamlineFeatures features = featuresOf(findTopology(faces, field));
#pragma once

#include "streamlines/evenly_spaced.h"
#include "topology/topology.h"

namespace stormfield {

/// Curves in the order of Topology::periodicOrbits, then Topology::separatrices. A separatrix that leads to a source or
/// sink ends before it.
StreamlineFeatures featuresOf(const Topology& topology);

}  // namespace stormfield
