// Disjoint sets of faces of one mesh, with the way back from a face to its set.
#pragma once

#include <vector>

#include "base/types.h"

namespace stormfield {

/// Sets are numbered from 0; the faces of a set ascend.
class IndexSets {
 public:
  IndexSets() = default;
  /// setOf: per face its set, or kNone; every number below count occurs.
  IndexSets(std::vector<Index> setOf, Index count);

  Index count() const { return static_cast<Index>(members_.size()); }
  const std::vector<Index>& faces(Index set) const { return members_[set]; }
  /// Per face, kNone for faces in no set.
  const std::vector<Index>& setOf() const { return setOf_; }
  Index setOf(Index face) const { return setOf_[face]; }
  /// Place of a face within faces(setOf(face)).
  Index placeOf(Index face) const { return placeOf_[face]; }

 private:
  std::vector<Index> setOf_, placeOf_;
  std::vector<std::vector<Index>> members_;
};

}  // namespace stormfield
