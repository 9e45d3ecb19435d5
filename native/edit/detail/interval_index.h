// The Conley index of an interval from its entities and the connections between them, without a block: the homology over
// Z/2 of the chain complex of its connection matrix (Franzosa 1989, The connection matrix theory for Morse
// decompositions; thesis 2.3).
//
// A sink has a class of dimension 0, a saddle of 1, a source of 2, an attracting orbit of 0 and 1, a repelling one of 1
// and 2. The boundary of a saddle is the sum of the ends of its outgoing separatrices, and it is in the boundary of what
// its incoming separatrices come from, once for each. The class of dimension 1 of a repelling orbit is a short curve across
// it, of which one end leads to the attractor of the interval; reversed, the same holds for an attracting orbit.
//
//   const ConleyIndex index = intervalIndex(topology, interval);
#pragma once

#include "edit/interval.h"
#include "morse/conley_index.h"

namespace stormfield {

ConleyIndex intervalIndex(const Topology& topology, const Interval& interval);

}  // namespace stormfield
