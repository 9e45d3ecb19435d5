// When strongly connected sets merge as the error bound grows: every edge of an ErrorBoundedMap gets the least epsilon
// at which its two ends lie in one strongly connected set, and every Morse set the least epsilon at which it lies in
// one with another Morse set, its persistence (thesis 6.4; as in persistent homology, on the sets of one epsilon).
//
// All epsilons are treated at once: the edges are sorted by when they appear, and the levels are found by bisection;
// edges within a set of the middle epsilon go to the lower half, the others, with those sets contracted, to the upper
// half. Each edge is looked at once for every halving: O(m log m) time for m edges.
//
//   const MergeLevels levels = mergeLevels(bounded, progress);
//   const std::vector<double> persistence = persistenceOf(levels, sets, epsilon);
#pragma once

#include <vector>

#include "base/progress.h"
#include "morse/error_bound.h"
#include "morse/face_sets.h"

namespace stormfield {

/// Pairs of neighbouring faces by the epsilon from which they are in one strongly connected set, ascending. Pairs that
/// follow from earlier ones are left out, so that there are fewer pairs than faces.
struct MergeLevels {
  std::vector<double> epsilon;
  std::vector<Index> first, second;
};

MergeLevels mergeLevels(const ErrorBoundedMap& bounded, Progress& progress);

/// Per set the least epsilon above the given one at which it merges with another of the sets; infinite when it never
/// does. The sets must be strongly connected sets at that epsilon.
std::vector<double> persistenceOf(const MergeLevels& levels, const FaceSets& sets, double epsilon);

}  // namespace stormfield
