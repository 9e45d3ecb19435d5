// Why a refinement of Morse sets went no further.
#pragma once

#include "base/words.h"

namespace stormfield {

enum class RefinementStop {
  Done,       ///< no set is left to refine
  Steps,      ///< the steps allowed were used
  Time,       ///< the seconds allowed have passed
  Memory,     ///< more would not fit into the memory allowed
  Cancelled,  ///< the caller's Progress was cancelled; the sets are those of the last complete round
};
template <>
inline constexpr Words kWords<RefinementStop>{"reason to stop refining",
                                              {"done", "steps", "time", "memory", "cancelled"}};

}  // namespace stormfield
