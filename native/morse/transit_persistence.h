// Persistence of refined Morse sets (persistence.h; thesis 6.4): the least error bound epsilon at which a set merges
// with another, on the pieces that a refinement has come to.
//
// The map of fixed pieces grows with epsilon (transit_map.h), so that sets that lie in one strongly connected set go on
// to do so. Epsilon is looked at on a ladder of steps by a factor of kPersistenceStep, and there by bisection: nothing
// happens between two steps with the same sets in common. What is returned is the first step at which a set has merged:
// it does so within a factor of kPersistenceStep below. The first step is a millionth of the largest speed. Each step
// that is looked at costs a map of all pieces.
//
// Faces that hold a fixed point are known by their exits only as soon as there is an error bound (cone_transit.h), so
// that sets that meet in such a face merge at the first step: their persistence is a lower bound.
//
//   const std::vector<double> persistence = transitPersistence(refinement, decomposition.nodes, progress);
#pragma once

#include <vector>

#include "base/progress.h"
#include "morse/index_sets.h"
#include "morse/transit_refinement.h"

namespace stormfield {

/// Relative accuracy of the persistence of refined sets.
constexpr double kPersistenceStep = 2.0;

/// nodes: of each set, of the refinement's decomposition. Per set the least epsilon above the refinement's own at which
/// it merges with another; infinite when it never does. Throws Cancelled.
std::vector<double> transitPersistence(const TransitRefinement& refinement, const NodeSets& nodes, Progress& progress);

}  // namespace stormfield
