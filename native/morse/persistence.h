// When strongly connected sets merge as the error bound grows: a tree in which every face is absorbed by another at the
// least epsilon at which both lie in one strongly connected set (Tarjan's hierarchical decomposition by strong
// components), and every Morse set's persistence, the least epsilon at which it lies in one with another Morse set
// (thesis 6.4; as in persistent homology, on the sets of one epsilon).
//
// All epsilons are treated at once. A part of the graph is halved at an epsilon in the middle of those of its edges:
// each strongly connected set of that epsilon is a part of its own, with the edges up to there, and with these sets
// contracted the rest is one more. Every part is halved by its own edges, so that a part of m edges is looked at about
// log m times, and the small ones, which are nearly all, are not halved at all: O(m log m) time for m edges, close to
// O(m) on meshes.
//
//   const MergeLevels levels = mergeLevels(bounded, progress);
//   const std::vector<double> persistence = persistenceOf(levels, sets, epsilon);
#pragma once

#include <vector>

#include "base/progress.h"
#include "maps/error_bound.h"
#include "morse/index_sets.h"

namespace stormfield {

/// By ascending epsilon: from there on `second` is in one strongly connected set with `first`, a lesser face. Each face
/// is absorbed once at most, after all that it has absorbed itself, so that the pairs up to an epsilon join just the
/// sets of that epsilon. The same for any number of threads.
struct MergeLevels {
  std::vector<double> epsilon;
  std::vector<Index> first, second;
};

/// Throws Cancelled.
MergeLevels mergeLevels(const ErrorBoundedMap& bounded, Progress& progress);

/// Per set the least epsilon above the given one at which it merges with another of the sets; infinite when it never
/// does. The sets must be strongly connected sets at that epsilon.
std::vector<double> persistenceOf(const MergeLevels& levels, const IndexSets& sets, double epsilon);

}  // namespace stormfield
