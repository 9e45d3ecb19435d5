// The exit set L of a set N of faces of a combinatorial map F (thesis 2.3.1, 8.2.3): the boundary edges of N beyond
// which lie faces that F leads to from N, and the boundary of the surface where flow leaves over it.
//
// The field across a boundary edge of the surface is linear, so that it changes sign at most once. There, and at
// boundary vertices, the flow may be tangent to the boundary. At an external tangency the trajectory lies outside the
// surface before and after, and N stays an isolating block. At an internal tangency it lies inside, and N is none: the
// index is that of the pair, with b0 - b1 + b2 = the sum of the Poincare indices less the number of internal
// tangencies.
//
//   const IndexPair pair = flowPair(field, geometryMap(field), sets, 0);
//   conleyIndex(field.mesh(), sets, 0, pair).euler();   // the Poincare sum less internalTangencies(field, sets, 0)
#pragma once

#include "field/vector_field.h"
#include "maps/combinatorial_map.h"
#include "morse/conley_index.h"

namespace stormfield {

/// For a recurrent component of a geometry-based map: an isolating block of the flow.
IndexPair flowPair(const VectorField& field, const CombinatorialMap& map, const FaceSets& sets, Index set);

/// For a recurrent component of any map: N and L are the closed unions of its faces and of those that F leads to from
/// N, and L is taken within N, which by excision has the same homology.
IndexPair mapPair(const VectorField& field, const CombinatorialMap& map, const FaceSets& sets, Index set);

/// Tangencies of the flow to the boundary of the surface from inside N, for an isolating block of the flow.
int internalTangencies(const VectorField& field, const FaceSets& sets, Index set);

}  // namespace stormfield
