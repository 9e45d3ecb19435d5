// The border of a set N of faces and the flow across it (thesis 2.3.1; Conley 1978): the exit set L, and where N is no
// isolating block.
//
// On an edge the component of the field across it is linear, so that the flow changes between entering and leaving at
// most once on an edge, and else at a vertex of the border. Such a place is an external tangency where the trajectory
// through it lies outside N before and after, and an internal one where it lies inside. N is an isolating block where
// there is no internal tangency. Unlike the components of a combinatorial map (morse/detail/exit_set.h), N may be
// any set of faces.
#pragma once

#include <vector>

#include "field/vector_field.h"
#include "morse/conley_index.h"

namespace stormfield {

struct BlockBorder {
  IndexPair pair;
  /// Per internal tangency the halfedge in N on which it lies, or at whose tail.
  struct Tangency {
    Index halfedge = kNone;
    bool atTail = false;
  };
  std::vector<Tangency> internalTangencies;
};

/// Of set 0.
BlockBorder blockBorder(const VectorField& field, const FaceSets& sets);

}  // namespace stormfield
