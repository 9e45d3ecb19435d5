#include "morse/index_sets.h"

#include <utility>

namespace stormfield {

IndexSets::IndexSets(std::vector<Index> setOf, Index count)
    : setOf_(std::move(setOf)), placeOf_(setOf_.size(), kNone), members_(count) {
  for (Index i = 0; i < static_cast<Index>(setOf_.size()); ++i) {
    if (setOf_[i] == kNone) continue;
    std::vector<Index>& members = members_[setOf_[i]];
    placeOf_[i] = static_cast<Index>(members.size());
    members.push_back(i);
  }
}

}  // namespace stormfield
