// The first stage of tau map rows: vertices are advected and edges sampled (thesis 7.1.1).
#pragma once

#include <vector>

#include "maps/detail/block_lists.h"
#include "maps/detail/row_task.h"

namespace stormfield {

/// By the slot of the edge in task.edges.
struct ForwardImages {
  BlockLists faces;                 ///< that the edge's image meets, ascending
  std::vector<char> leavesSurface;  ///< whether some of it may have left the surface
};

/// Throws InputError where the memory budget is exceeded, and Cancelled.
ForwardImages forwardImages(RowTask& task);

}  // namespace stormfield
