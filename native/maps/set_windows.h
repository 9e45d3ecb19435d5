// Where the image of a Morse set can be left out of sight: what has left the set for ever.
//
// Let S be a strongly connected component of an outer approximation of phi(tau, .) within a set that holds it. A point
// x of S whose image phi(tau, x) is not in S never comes back: phi(k tau, x) is outside S for all k >= 1, as a way back
// in F would make its face part of S (thesis 8.2.1). So the image of S at a multiple of tau is needed only as far as it
// was in S at the multiples before. The refinement knows such sets for tau, 2 tau, 4 tau ..., each within the one
// before.
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

/// The sets that images of one Morse set are followed in, step by step.
struct SetWindows {
  int steps = 1;  ///< tau is so many steps, advectionStepCount (tau_rows.h)
  std::vector<SharedFaces>
      levels;  ///< level j: the set that holds after every multiple of 2^j steps; null for all faces
  std::size_t memoryLimit = std::numeric_limits<std::size_t>::max();  ///< bytes that the set's rows may take

  /// Whether a point of the set that is in this face after a step may come back; after the last it need not.
  bool holds(int step, Index face) const {
    if (step == steps || levels.empty()) return true;
    const auto level = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(step)));
    const SharedFaces& faces = levels[std::min(level, levels.size() - 1)];
    return faces == nullptr || std::binary_search(faces->begin(), faces->end(), face);
  }
};

}  // namespace stormfield
