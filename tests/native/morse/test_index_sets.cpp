#include "morse/index_sets.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace stormfield::test {
namespace {

// What is of faces is not taken for what is of other nodes.
static_assert(!std::is_convertible_v<NodeSets, FaceSets> && !std::is_convertible_v<FaceSets, NodeSets>);
static_assert(!std::is_convertible_v<IndexSets, FaceSets> && !std::is_convertible_v<IndexSets, NodeSets>);

TEST(IndexSets, AreFoundFromTheirMembersAndBack) {
  const FaceSets sets({2, kNone, 0, 2, 1, 2}, 3);
  ASSERT_EQ(sets.count(), 3);
  EXPECT_EQ(sets.members(0), (std::vector<Index>{2}));
  EXPECT_EQ(sets.members(1), (std::vector<Index>{4}));
  EXPECT_EQ(sets.members(2), (std::vector<Index>{0, 3, 5}));
  EXPECT_EQ(sets.setOf(3), 2);
  EXPECT_EQ(sets.setOf(1), kNone);
  EXPECT_EQ(sets.placeOf(5), 2);
  EXPECT_EQ(sets.placeOf(1), kNone);
}

TEST(IndexSets, MayBeNone) {
  EXPECT_EQ(FaceSets().count(), 0);
  EXPECT_EQ(NodeSets({kNone, kNone}, 0).setOf(), (std::vector<Index>{kNone, kNone}));
}

}  // namespace
}  // namespace stormfield::test
