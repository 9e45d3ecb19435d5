#include "morse/morse_connection_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "fixtures.h"

namespace stormfield::test {
namespace {

using Edges = std::vector<std::array<Index, 2>>;

/// A map of so many nodes, of which the last is outside.
CombinatorialMap mapWith(Index nodes, const Edges& edges) {
  std::vector<std::vector<Index>> rows(nodes - 1);
  for (const auto& [from, to] : edges) rows[from].push_back(to);
  for (std::vector<Index>& row : rows) std::sort(row.begin(), row.end());
  return mapFromRows(rows);
}

MorseConnectionGraph graphOf(const CombinatorialMap& map, const NodeSets& sets) {
  return morseConnectionGraph(map, stronglyConnectedComponents(map.graph), sets);
}

// Nodes 0 and 1 are one set, 3 and 5 are two; 2 and 4 lie between; 6 is outside.
const Edges kChain{{0, 1}, {1, 0}, {1, 2}, {2, 3}, {3, 3}, {3, 4}, {4, 5}, {5, 5}};
NodeSets chainSets() {
  return {{0, 0, kNone, 1, kNone, 2}, 3};
}

TEST(MorseConnectionGraph, LeavesOutWhatLiesBetweenAndWhatFollows) {
  EXPECT_EQ(graphOf(mapWith(7, kChain), chainSets()).edges, (Edges{{0, 1}, {1, 2}}));
  // A shortcut past the set in the middle follows from the chain.
  Edges more = kChain;
  more.push_back({0, 4});
  EXPECT_EQ(graphOf(mapWith(7, more), chainSets()).edges, (Edges{{0, 1}, {1, 2}}));
}

TEST(MorseConnectionGraph, LeadsThroughComponentsThatAreNoSets) {
  const NodeSets ends({0, 0, kNone, kNone, kNone, 1}, 2);
  EXPECT_EQ(graphOf(mapWith(7, kChain), ends).edges, (Edges{{0, 1}}));
}

TEST(MorseConnectionGraph, OfADiamondHasItsFourSides) {
  const CombinatorialMap map = mapWith(5, {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1}, {1, 3}, {2, 2}, {2, 3}, {3, 3}});
  EXPECT_EQ(graphOf(map, NodeSets({0, 1, 2, 3}, 4)).edges, (Edges{{0, 1}, {0, 2}, {1, 3}, {2, 3}}));
}

TEST(MorseConnectionGraph, SaysWhichSetsFlowLeavesTheSurfaceFrom) {
  EXPECT_EQ(graphOf(mapWith(7, kChain), chainSets()).outflow, (std::vector<char>{0, 0, 0}));
  Edges leaving = kChain;
  leaving.push_back({4, 6});
  EXPECT_EQ(graphOf(mapWith(7, leaving), chainSets()).outflow, (std::vector<char>{1, 1, 0}));
  // From the last set, which all others lead to.
  leaving.back() = {5, 6};
  EXPECT_EQ(graphOf(mapWith(7, leaving), chainSets()).outflow, (std::vector<char>{1, 1, 1}));
}

TEST(MorseConnectionGraph, OfNoSetsIsEmpty) {
  const MorseConnectionGraph graph = graphOf(mapWith(7, kChain), NodeSets(std::vector<Index>(6, kNone), 0));
  EXPECT_TRUE(graph.edges.empty());
  EXPECT_TRUE(graph.outflow.empty());
}

TEST(ConnectionRegion, IsWhatLiesOnPathsBetweenTwoSets) {
  const CombinatorialMap map = mapWith(7, kChain);
  EXPECT_EQ(connectionRegion(map, chainSets(), 0, 1), (std::vector<Index>{2}));
  // The set in the middle lies between the other two.
  EXPECT_EQ(connectionRegion(map, chainSets(), 0, 2), (std::vector<Index>{2, 3, 4}));
  EXPECT_TRUE(connectionRegion(map, chainSets(), 2, 0).empty());
}

TEST(ConnectionRegion, HasNoDeadEnds) {
  // Node 3 is led to and leads nowhere; node 4 leads there and is not led to.
  const CombinatorialMap map = mapWith(6, {{0, 0}, {0, 1}, {0, 3}, {1, 2}, {2, 2}, {4, 1}});
  EXPECT_EQ(connectionRegion(map, NodeSets({0, kNone, 1, kNone, kNone}, 2), 0, 1), (std::vector<Index>{1}));
}

}  // namespace
}  // namespace stormfield::test
