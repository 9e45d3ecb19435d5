// The recurrent components of the geometry-based map that may hold a periodic orbit: its strongly connected components
// (Tarjan 1972; thesis 2.4.2, 3.1). A periodic orbit lies in one of them altogether.
//
//   const RecurrentComponents components = recurrentComponents(field, geometryMap(field), fixedPointFaces(field));
#pragma once

#include <vector>

#include "field/vector_field.h"
#include "maps/combinatorial_map.h"
#include "tracing/trace.h"

namespace stormfield {

struct ComponentSeed {
  SurfacePoint point;
  Direction direction = Direction::Forward;  ///< into the component
  Index component = kNone;
};

struct RecurrentComponents {
  std::vector<Index> of;  ///< component of each face, kNone where no periodic orbit can be
  Index count = 0;
  /// Where streamlines enter the components that hold no fixed point: no other streamline may lead to their orbits. One
  /// for each run of their border that is crossed in one direction; any point where there is none.
  std::vector<ComponentSeed> seeds;
};

/// Left out: single faces, and disks without a fixed point (a closed streamline in a disk surrounds one).
/// holdsFixedPoint: per face.
RecurrentComponents recurrentComponents(const VectorField& field, const CombinatorialMap& map,
                                        const std::vector<char>& holdsFixedPoint);

}  // namespace stormfield
