#include "morse/index_sets.h"

#include <utility>

namespace stormfield {

IndexSets::IndexSets(std::vector<Index> setOf, Index count)
    : setOf_(std::move(setOf)), placeOf_(setOf_.size(), kNone), members_(count) {
  for (Index f = 0; f < static_cast<Index>(setOf_.size()); ++f) {
    if (setOf_[f] == kNone) continue;
    std::vector<Index>& faces = members_[setOf_[f]];
    placeOf_[f] = static_cast<Index>(faces.size());
    faces.push_back(f);
  }
}

}  // namespace stormfield
