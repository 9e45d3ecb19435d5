// The parts of the surface in which the flow can come back: strongly connected components of the geometry-based map
// (thesis 2.4.2, 3.1). A periodic orbit lies in one of them altogether.
#pragma once

#include <vector>

#include "field/vector_field.h"
#include "maps/combinatorial_map.h"
#include "tracing/trace.h"

namespace stormfield {

struct PartSeed {
  SurfacePoint point;
  Direction direction = Direction::Forward;  ///< into the part
  Index part = kNone;
};

struct RecurrentParts {
  std::vector<Index> of;  ///< part of each face, kNone where no periodic orbit can be
  Index count = 0;
  /// Where streamlines enter the parts that hold no fixed point: nothing else may lead to their orbits. One for each
  /// run of their border that is crossed in one direction; any one where there is none.
  std::vector<PartSeed> seeds;
};

/// Left out: single faces, and disks without a fixed point (a closed streamline in a disk surrounds one).
/// resting: whether a face holds a fixed point.
RecurrentParts recurrentParts(const VectorField& field, const CombinatorialMap& map, const std::vector<char>& resting);

}  // namespace stormfield
