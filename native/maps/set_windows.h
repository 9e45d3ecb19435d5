// The windows of a Morse set: the sets in which images of the set are followed, step by step. A point that leaves its
// window never comes back to the set.
//
// Let S be a strongly connected component of an outer approximation of phi(tau, .) within a set that holds it. A point
// x of S whose image phi(tau, x) is not in S never comes back: phi(k tau, x) is outside S for all k >= 1, because a
// path back in F would make its face part of S (thesis 8.2.1). So the image of S at a multiple of tau is needed only as
// far as it was in S at the multiples before. The refinement knows such sets for tau, 2 tau, 4 tau ..., each within the
// one before.
//
//   SetWindows windows;
//   windows.steps = 4;
//   const bool follows = windows.contains(1, Index{17});
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "base/types.h"

namespace stormfield {

/// Faces of a set, ascending.
using SharedFaces = std::shared_ptr<const std::vector<Index>>;

struct SetWindows {
  int steps = 1;  ///< in which tau is followed: PreparedFlow::stepCount
  /// Level j: the set that holds after every odd multiple of 2^j steps; null for all faces. The last level holds after
  /// higher powers of two as well. Empty: all faces after every step.
  std::vector<SharedFaces> levels;
  std::size_t memoryLimit = std::numeric_limits<std::size_t>::max();  ///< bytes that the set's rows may take

  /// Whether the set's window after a step contains a face; after the last step every face is wanted.
  bool contains(int step, Index face) const {
    if (step == steps || levels.empty()) return true;
    const auto level = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(step)));
    const SharedFaces& faces = levels[std::min(level, levels.size() - 1)];
    return faces == nullptr || std::binary_search(faces->begin(), faces->end(), face);
  }
};

}  // namespace stormfield
