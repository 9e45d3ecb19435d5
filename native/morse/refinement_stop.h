// Why a refinement of Morse sets went no further.
#pragma once

namespace stormfield {

enum class RefinementStop {
  Done,       ///< no set is left to refine
  Steps,      ///< the steps allowed were used
  Time,       ///< the seconds allowed have passed
  Memory,     ///< more would not fit into the memory allowed
  Cancelled,  ///< the caller's Progress was cancelled; the sets are those of the last complete round
};

/// Lower-case word used in files and messages.
const char* name(RefinementStop stop);

}  // namespace stormfield
