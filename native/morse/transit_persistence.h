// Persistence of refined Morse sets (persistence.h; thesis 6.4): the least error bound epsilon at which a set merges
// with another, on the pieces of edges that a refinement has come to.
//
// The map of fixed pieces grows with epsilon (transit_map.h), so that sets that lie in one strongly connected component
// stay in one. Epsilon is tried at steps by a factor of kPersistenceStep from a millionth of the largest speed on, by
// bisection: between two steps with the same merged sets nothing happens. The result is the first step at which a set
// has merged, and exceeds its persistence by at most that factor. Each step that is tried takes a map of all pieces.
//
// Faces with a fixed point have rows by their exits alone once there is an error bound (cone_transit.h), so that sets
// that meet in such a face merge at the first step: their persistence is a lower bound.
//
//   const CombinatorialMap map = refinement.map().map(&progress);
//   const MorseDecomposition morse = refinement.decomposition(map, {}, progress);
//   const std::vector<double> persistence = transitPersistence(refinement, morse.withinFaces->nodes, progress);
#pragma once

#include <vector>

#include "base/progress.h"
#include "morse/index_sets.h"
#include "morse/transit_refinement.h"

namespace stormfield {

/// Factor from one epsilon that is tried to the next: the relative accuracy of the persistence of refined sets.
constexpr double kPersistenceStep = 2.0;

/// nodes: of the sets of the refinement's decomposition. Per set the least epsilon beyond the refinement's own at which
/// it merges with another; infinite when it never does. Throws Cancelled.
std::vector<double> transitPersistence(const TransitRefinement& refinement, const NodeSets& nodes, Progress& progress);

}  // namespace stormfield
