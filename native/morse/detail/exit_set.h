// The exit set L of a set N of faces of a combinatorial map F (thesis 2.3.1, 8.2.3): where N ends in faces that F leads
// to from N, and where flow leaves over the boundary of the surface.
//
// A boundary edge of the surface may be left over a part of it only: the field across it is linear, and changes sign at
// most once. Where it does, and at boundary vertices, the flow touches the boundary, from outside (it was gone before
// and is gone after: fine) or from inside. A touch from inside is a grazing: the set is then no isolated one, as with
// any boundary that cuts through the flow, and its index is that of the pair, with b0 - b1 + b2 = the sum of the
// Poincare indices less the number of grazings.
#pragma once

#include "field/vector_field.h"
#include "maps/combinatorial_map.h"
#include "morse/conley_index.h"

namespace stormfield {

/// For the strongly connected sets of a geometry-based map: an isolating block of the flow.
IndexPair flowPair(const VectorField& field, const CombinatorialMap& map, const FaceSets& sets, Index set);

/// For any strongly connected set of any map: N and L are the closed unions of its faces and of F(N) less N, seen
/// within N (by excision the same homology).
IndexPair mapPair(const VectorField& field, const CombinatorialMap& map, const FaceSets& sets, Index set);

/// Grazings of the boundary of the surface, for an isolating block of the flow.
int grazings(const VectorField& field, const FaceSets& sets, Index set);

}  // namespace stormfield
