#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "fixtures.h"
#include "morse/detail/union_find.h"

namespace stormfield::test {
namespace {

TEST(UnionFind, NamesEachClassByItsLeastMember) {
  UnionFind classes(5);
  EXPECT_TRUE(classes.join(4, 2));
  EXPECT_EQ(classes.find(4), 2);
  EXPECT_TRUE(classes.join(1, 4));
  EXPECT_EQ(classes.find(2), 1);
  EXPECT_FALSE(classes.join(2, 1));
  EXPECT_EQ(classes.find(0), 0);
  EXPECT_EQ(classes.find(3), 3);
}

TEST(UnionFind, HasTheClassesOfRelabellingAll) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const Index count = 1 + random.below(60);
    UnionFind classes(count);
    std::vector<Index> label(count);  // the least member of each class, all of them kept up to date
    for (Index i = 0; i < count; ++i) label[i] = i;
    for (int i = 0; i < 40; ++i) {
      const Index a = random.below(count), b = random.below(count);
      const Index least = std::min(label[a], label[b]), other = std::max(label[a], label[b]);
      EXPECT_EQ(classes.join(a, b), least != other);
      std::replace(label.begin(), label.end(), other, least);
      for (Index k = 0; k < count; ++k) ASSERT_EQ(classes.find(k), label[k]);
    }
  }
}

}  // namespace
}  // namespace stormfield::test
