#include "maps/directed_graph.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <set>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

using Matrix = std::vector<std::vector<char>>;

DirectedGraph graphOf(Index nodes, const std::set<std::pair<Index, Index>>& edges) {
  DirectedGraph graph;
  auto edge = edges.begin();
  for (Index node = 0; node < nodes; ++node) {
    for (; edge != edges.end() && edge->first == node; ++edge) graph.targets.push_back(edge->second);
    graph.offsets.push_back(graph.targets.size());
  }
  return graph;
}

DirectedGraph randomGraph(Index nodes, int edges, bool acyclic, Random& random) {
  std::set<std::pair<Index, Index>> chosen;
  for (int i = 0; i < edges; ++i) {
    Index a = random.below(nodes), b = random.below(nodes);
    if (acyclic && a == b) continue;
    // Not along the numbers, so that the order has to be found.
    if (acyclic && (a * 7919) % nodes > (b * 7919) % nodes) std::swap(a, b);
    chosen.emplace(a, b);
  }
  return graphOf(nodes, chosen);
}

/// Paths of at least one edge (Warshall).
Matrix reachability(const DirectedGraph& graph) {
  const Index n = graph.nodeCount();
  Matrix reach(n, std::vector<char>(n, 0));
  for (Index a = 0; a < n; ++a) {
    for (const Index* t = graph.begin(a); t != graph.end(a); ++t) reach[a][*t] = 1;
  }
  for (Index k = 0; k < n; ++k) {
    for (Index a = 0; a < n; ++a) {
      for (Index b = 0; reach[a][k] != 0 && b < n; ++b) reach[a][b] |= reach[k][b];
    }
  }
  return reach;
}

void expectRowsSorted(const DirectedGraph& graph) {
  ASSERT_EQ(graph.offsets.back(), graph.targets.size());
  for (Index node = 0; node < graph.nodeCount(); ++node) {
    EXPECT_EQ(std::adjacent_find(graph.begin(node), graph.end(node), std::greater_equal<>()), graph.end(node));
  }
}

TEST(DirectedGraph, ReachableIsTheStartAndAllThatPathsLeadTo) {
  Random random(11);
  for (int run = 0; run < 20; ++run) {
    const DirectedGraph graph = randomGraph(20, 25, false, random);
    const Matrix reach = reachability(graph);
    const Index a = random.below(20), b = random.below(20);
    const std::vector<char> seen = reachable(graph, {a, b});
    for (Index node = 0; node < 20; ++node) {
      EXPECT_EQ(seen[node] != 0, node == a || node == b || reach[a][node] != 0 || reach[b][node] != 0);
    }
  }
  EXPECT_EQ(reachable(randomGraph(3, 3, false, random), {}), std::vector<char>(3, 0));
}

TEST(StronglyConnectedComponents, AgreeWithReachability) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const Index n = 1 + random.below(24);
    const DirectedGraph graph = randomGraph(n, random.below(3 * n), false, random);
    const Matrix reach = reachability(graph);
    const Components components = stronglyConnectedComponents(graph);
    std::vector<Index> sizes(components.count(), 0);
    for (Index a = 0; a < n; ++a) {
      ++sizes[components.of[a]];
      EXPECT_EQ(components.recurrent[components.of[a]] != 0, reach[a][a] != 0);
      for (Index b = 0; b < n; ++b) {
        EXPECT_EQ(components.of[a] == components.of[b], a == b || (reach[a][b] != 0 && reach[b][a] != 0));
        if (reach[a][b] != 0) {
          EXPECT_GE(components.of[a], components.of[b]);
        }
      }
    }
    EXPECT_EQ(sizes, components.sizes);
  }
}

TEST(StronglyConnectedComponents, OfLongChainsAndCycles) {
  constexpr Index kNodes = 1000000;
  DirectedGraph chain;
  for (Index node = 0; node < kNodes; ++node) {
    if (node + 1 < kNodes) chain.targets.push_back(node + 1);
    chain.offsets.push_back(chain.targets.size());
  }
  EXPECT_EQ(stronglyConnectedComponents(chain).count(), kNodes);
  chain.targets.push_back(0);
  ++chain.offsets.back();
  const Components cycle = stronglyConnectedComponents(chain);
  EXPECT_EQ(cycle.count(), 1);
  EXPECT_EQ(cycle.sizes[0], kNodes);
}

TEST(StronglyConnectedComponents, OfTheEmptyGraph) {
  EXPECT_EQ(stronglyConnectedComponents({}).count(), 0);
  EXPECT_EQ(transitiveReduction({}).nodeCount(), 0);
}

TEST(Reversed, TurnsEveryEdge) {
  Random random(2);
  const DirectedGraph graph = randomGraph(50, 200, false, random);
  const DirectedGraph back = reversed(graph);
  expectRowsSorted(back);
  EXPECT_EQ(back.edgeCount(), graph.edgeCount());
  for (Index a = 0; a < 50; ++a) {
    for (const Index* t = graph.begin(a); t != graph.end(a); ++t) {
      EXPECT_TRUE(std::binary_search(back.begin(*t), back.end(*t), a));
    }
  }
  const DirectedGraph again = reversed(back);
  EXPECT_EQ(again.offsets, graph.offsets);
  EXPECT_EQ(again.targets, graph.targets);
}

TEST(Condensation, KeepsReachabilityBetweenComponents) {
  Random random(3);
  for (int round = 0; round < 100; ++round) {
    const Index n = 1 + random.below(24);
    const DirectedGraph graph = randomGraph(n, random.below(2 * n), false, random);
    const Components components = stronglyConnectedComponents(graph);
    const DirectedGraph order = condensation(graph, components);
    ASSERT_EQ(order.nodeCount(), components.count());
    expectRowsSorted(order);
    const Matrix fine = reachability(graph), coarse = reachability(order);
    for (Index a = 0; a < n; ++a) {
      EXPECT_EQ(coarse[components.of[a]][components.of[a]], 0);
      for (Index b = 0; b < n; ++b) {
        if (components.of[a] != components.of[b]) {
          EXPECT_EQ(fine[a][b], coarse[components.of[a]][components.of[b]]);
        }
      }
    }
  }
}

TEST(TransitiveReduction, KeepsReachabilityWithTheFewestEdges) {
  Random random(4);
  for (int round = 0; round < 300; ++round) {
    const Index n = 1 + random.below(24);
    const DirectedGraph graph = randomGraph(n, random.below(5 * n), true, random);
    const DirectedGraph reduced = transitiveReduction(graph);
    expectRowsSorted(reduced);
    const Matrix reach = reachability(graph);
    EXPECT_EQ(reachability(reduced), reach);
    for (Index a = 0; a < n; ++a) {
      for (Index b = 0; b < n; ++b) {
        // The reduction of an acyclic graph is unique: what is reached, and by no detour.
        bool detour = false;
        for (Index k = 0; k < n; ++k) detour = detour || (reach[a][k] != 0 && reach[k][b] != 0);
        EXPECT_EQ(std::binary_search(reduced.begin(a), reduced.end(a), b), reach[a][b] != 0 && !detour);
      }
    }
  }
}

TEST(TransitiveReduction, OfManyNodes) {
  // Every node leads to the next three: only the next is needed.
  constexpr Index kNodes = 20000;
  DirectedGraph graph;
  for (Index node = 0; node < kNodes; ++node) {
    for (Index step = 1; step <= 3 && node + step < kNodes; ++step) graph.targets.push_back(node + step);
    graph.offsets.push_back(graph.targets.size());
  }
  const DirectedGraph reduced = transitiveReduction(graph);
  ASSERT_EQ(reduced.edgeCount(), static_cast<std::size_t>(kNodes - 1));
  for (Index node = 0; node + 1 < kNodes; ++node) EXPECT_EQ(*reduced.begin(node), node + 1);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(transitiveReduction(graph).targets, reduced.targets);
}

TEST(TransitiveReduction, RefusesCycles) {
  expectFault<InputError>(
      [] {
        transitiveReduction(graphOf(3, {{0, 1}, {1, 2}, {2, 0}}));
      },
      {"acyclic", "condensation"});
  expectFault<InputError>([] { transitiveReduction(graphOf(2, {{0, 1}, {1, 1}})); }, {"acyclic"});
}

}  // namespace
}  // namespace stormfield::test
