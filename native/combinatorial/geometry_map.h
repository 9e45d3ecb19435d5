// The geometry-based combinatorial map (thesis 2.4.2, 6.2): a -> b where flow crosses the common edge from a to b.
//
// The field along an edge is the linear blend of its two carried end vectors, the same from both faces (thesis 2.5), so
// the directions of crossing are exact: an edge is crossed one way, the other, or both. A face that holds a fixed point
// has an edge to itself; a boundary edge that is crossed outwards leads to outside().
#pragma once

#include "combinatorial/combinatorial_map.h"
#include "field/vector_field.h"

namespace stormfield {

/// The same for any number of threads.
CombinatorialMap geometryMap(const VectorField& field);

}  // namespace stormfield
