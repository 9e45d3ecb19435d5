// At which error bound strongly connected sets merge: a tree in which every node is absorbed by another at the least
// epsilon at which both lie in one strongly connected component (Tarjan 1982, A hierarchical clustering algorithm using
// strong components). The persistence of a Morse set is the least epsilon at which it lies in one component with
// another Morse set (thesis 6.4), after persistent homology (Edelsbrunner, Letscher, Zomorodian 2002).
//
// All epsilons are treated at once. A subgraph is divided at an epsilon in the middle of those of its edges: each
// strongly connected set of that epsilon is a subgraph of its own, with the edges up to there, and with these sets
// contracted the rest is one more. A subgraph of m edges is so visited about log m times; those of up to 64 nodes,
// which are nearly all, are solved directly. O(m log m) time for m edges.
//
//   const MergeLevels levels = mergeLevels(bounded, progress);
//   const std::vector<double> persistence = persistenceOf(levels, sets, epsilon);
#pragma once

#include <vector>

#include "base/progress.h"
#include "maps/error_bound.h"
#include "morse/index_sets.h"

namespace stormfield {

/// By ascending epsilon: from there on node `second` is in one strongly connected component with `first`, a lesser
/// node. Each node is absorbed at most once, after all that it has absorbed itself, so that the pairs up to an epsilon
/// join exactly the components of that epsilon. The same for any number of threads.
struct MergeLevels {
  std::vector<double> epsilon;
  std::vector<Index> first, second;
};

/// Throws Cancelled.
MergeLevels mergeLevels(const ErrorBoundedMap& bounded, Progress& progress);

/// Per set the least epsilon above the given one at which it merges with another of the sets; infinite when it never
/// does. The sets must be strongly connected components at that epsilon.
std::vector<double> persistenceOf(const MergeLevels& levels, const IndexSets& sets, double epsilon);

}  // namespace stormfield
