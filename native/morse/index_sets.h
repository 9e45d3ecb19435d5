// Disjoint sets of the indices 0 .. n-1, with the way back from an index to its set: of the faces of a mesh, or of the
// nodes of a combinatorial map, which are not always faces (transit_map.h).
//
//   const FaceSets sets({0, kNone, 1, 0}, 2);
//   sets.members(0);     // {0, 3}
//   sets.setOf(2);       // 1
//   sets.placeOf(3);     // 1: members(0)[1] is 3
#pragma once

#include <utility>
#include <vector>

#include "base/types.h"

namespace stormfield {

/// Sets are numbered from 0; the members of a set ascend.
class IndexSets {
 public:
  IndexSets() = default;
  /// setOf: per index its set, or kNone; every number below count occurs.
  IndexSets(std::vector<Index> setOf, Index count);

  Index count() const { return static_cast<Index>(members_.size()); }
  const std::vector<Index>& members(Index set) const { return members_[set]; }
  /// Per index, kNone for those in no set.
  const std::vector<Index>& setOf() const { return setOf_; }
  Index setOf(Index index) const { return setOf_[index]; }
  /// Place of an index within members(setOf(index)).
  Index placeOf(Index index) const { return placeOf_[index]; }

 private:
  std::vector<Index> setOf_, placeOf_;
  std::vector<std::vector<Index>> members_;
};

/// Sets of faces of one mesh. A map whose nodes are the faces (combinatorial_map.h) may take them for sets of nodes,
/// which is why these are IndexSets; sets of other nodes are none of these.
class FaceSets : public IndexSets {
 public:
  using IndexSets::IndexSets;
};

/// Sets of nodes of a map that has other nodes than the faces.
class NodeSets : public IndexSets {
 public:
  using IndexSets::IndexSets;
};

}  // namespace stormfield
