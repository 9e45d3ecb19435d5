// The band of closed streamlines around an orbit: its faces, and where it ends on both sides (thesis 3.1).
#pragma once

#include <optional>
#include <vector>

#include "base/progress.h"
#include "topology/detail/orbit_search.h"

namespace stormfield {

struct OrbitBand {
  std::vector<Index> faces;  ///< some more than once
  /// The first point across each side whose streamline does not close; none where the band ends with the surface or in
  /// a fixed point.
  BothSides<std::optional<SurfacePoint>> ends;
};

/// Crosses the band along the streamlines of the field rotated by a right angle, and tests at every edge whether the
/// field's own streamline closes. tolerance: of one step, in mean edge lengths; bandTolerance as in TopologyOptions.
OrbitBand findBand(const FlatFaces& faces, const VectorField& field, const OrbitSearch& orbits, const FoundOrbit& found,
                   Index component, double tolerance, double bandTolerance, const Progress* progress);

}  // namespace stormfield
