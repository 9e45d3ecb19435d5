// Rows of some faces against those of the whole map, and what they are made with.
#include "maps/tau_rows.h"

#include <gtest/gtest.h>

#include <limits>

#include "checks.h"
#include "fixtures.h"
#include "maps/detail/block_lists.h"
#include "maps/detail/memory_budget.h"
#include "maps/detail/vertex_origins.h"
#include "maps/tau_map.h"

namespace stormfield::test {
namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

SharedFaces shared(std::vector<Index> faces) {
  return std::make_shared<const std::vector<Index>>(std::move(faces));
}

TEST(TauRows, AreThoseOfTheWholeMap) {
  const auto charts = makeCharts(torus(10, 6));
  const FlatFaces faces(charts);
  const VectorField field = randomField(charts, 5);
  const double tau = startingTau(field, TauUnit::Time, 0.5);
  const CombinatorialMap map = tauMap(faces, field, tau);
  const PreparedFlow flow(faces, field, TauUnit::Time, TauMapOptions{}.tolerance);
  const std::vector<Index> chosen{3, 17, 40, 41};
  TauWork work;
  const TauRows rows = tauRows(flow, chosen, tau, kUnlimited, nullptr, &work);
  EXPECT_GT(work.traces, 0U);
  ASSERT_EQ(rows.offsets.size(), chosen.size() + 1);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    EXPECT_EQ(std::vector<Index>(rows.targets.begin() + static_cast<std::ptrdiff_t>(rows.offsets[i]),
                                 rows.targets.begin() + static_cast<std::ptrdiff_t>(rows.offsets[i + 1])),
              std::vector<Index>(map.graph.begin(chosen[i]), map.graph.end(chosen[i])));
  }
  expectFault<InputError>([&] { tauRows(flow, chosen, tau, 100); }, {"MiB", "smaller tau"});
  SetWindows small;
  small.steps = flow.stepCount(tau);
  small.memoryLimit = 100;
  EXPECT_THROW(tauRowsWithinSet(flow, chosen, tau, small), InputError);
}

TEST(TauRows, JoinToOneMapInAnyGroups) {
  const CombinatorialMap map = mapFromRows(std::vector<std::vector<Index>>{{0, 1}, {2, 3}, {}});
  const CombinatorialMap joined = mapFromRowGroups(3, {{{1}, {{0, 2}, {2, 3}}}, {{0, 2}, {{0, 2, 2}, {0, 1}}}});
  EXPECT_EQ(joined.graph.offsets, map.graph.offsets);
  EXPECT_EQ(joined.graph.targets, map.graph.targets);
  EXPECT_EQ(joined.outside(), 3);
  const CombinatorialMap alone = mapFromRowGroups(3, {{{0, 1, 2}, {{0, 2, 4, 4}, {0, 1, 2, 3}}}});
  EXPECT_EQ(alone.graph.offsets, map.graph.offsets);
  EXPECT_EQ(alone.graph.targets, map.graph.targets);
  const TauRows rows = geometryRows(map, {1, 2});
  EXPECT_EQ(rows.offsets, (std::vector<std::size_t>{0, 2, 2}));
  EXPECT_EQ(rows.targets, (std::vector<Index>{2, 3}));
}

TEST(SetWindows, AreThoseOfTheLargestPowerOfTwoInTheStep) {
  SetWindows windows;
  windows.steps = 8;
  EXPECT_TRUE(windows.contains(3, 100));  // without levels
  windows.levels = {nullptr, shared({4, 7}), shared({7})};
  EXPECT_TRUE(windows.contains(1, 100));
  EXPECT_TRUE(windows.contains(3, 100));
  EXPECT_TRUE(windows.contains(2, 4));
  EXPECT_FALSE(windows.contains(6, 5));
  EXPECT_TRUE(windows.contains(4, 7));
  EXPECT_FALSE(windows.contains(4, 4));
  EXPECT_TRUE(windows.contains(8, 100));  // the end
  windows.steps = 16;
  EXPECT_FALSE(windows.contains(8, 4));  // the last level goes for higher powers too
}

TEST(MemoryBudget, RefusesMoreThanItsLimitAndKeepsThePeak) {
  MemoryBudget budget(std::size_t{3} << 20);
  budget.take(std::size_t{2} << 20);
  budget.giveBack(std::size_t{1} << 20);
  budget.take(std::size_t{2} << 20);
  EXPECT_EQ(budget.peak(), std::size_t{3} << 20);
  expectFault<InputError>([&] { budget.take(1); }, {"3 MiB"});
}

TEST(BlockLists, KeepListsInTheirPlaces) {
  constexpr std::size_t kCount = BlockLists::kBlockSize + 5;
  BlockLists lists(kCount);
  ASSERT_EQ(lists.blockCount(), 2U);
  EXPECT_EQ(lists.end(1), kCount);
  for (std::size_t i = kCount; i-- > 0;) {  // any order
    lists.append(i, std::vector<Index>(i % 3, static_cast<Index>(i)));
  }
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(lists.list(i).size(), i % 3);
    for (const Index value : lists.list(i)) EXPECT_EQ(value, static_cast<Index>(i));
  }
}

TEST(VertexOrigin, TellsFacesFromTheOtherStates) {
  EXPECT_FALSE(VertexOrigin().isRequested());
  EXPECT_TRUE(VertexOrigin::pending().isRequested());
  EXPECT_TRUE(VertexOrigin::none().isRequested());
  EXPECT_FALSE(VertexOrigin::pending().isFace());
  EXPECT_FALSE(VertexOrigin::none().isFace());
  EXPECT_TRUE(VertexOrigin(0).isFace());
  EXPECT_EQ(VertexOrigin(7).face(), 7);
  EXPECT_LT(VertexOrigin::none(), VertexOrigin(0));
}

}  // namespace
}  // namespace stormfield::test
