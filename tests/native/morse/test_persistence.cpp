#include "morse/persistence.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A graph of any kind: edges between random nodes near each other, loops and edges to the outside among them. Where
/// `levels` > 0, so many different epsilons besides 0; one edge in `rare` is there from the beginning, as many never
/// come.
ErrorBoundedMap randomMap(Index nodes, Index edgesOfNode, Index reach, int levels, int rare, Random& random) {
  ErrorBoundedMap result;
  for (Index node = 0; node < nodes; ++node) {
    std::vector<Index> targets;
    for (Index i = 0; i < edgesOfNode; ++i) {
      const Index target = node - reach + random.below(2 * reach + 1);
      targets.push_back(target < 0 ? nodes : std::min(target, nodes));
    }
    std::sort(targets.begin(), targets.end());
    targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
    for (const Index target : targets) {
      const double epsilon = levels > 0 ? 1.0 + random.below(levels) : random.uniform(0.0, 1.0);
      const int kind = random.below(rare);
      result.map.graph.targets.push_back(target);
      result.edgeEpsilon.push_back(kind == 0 ? 0.0 : kind == 1 ? kNever : epsilon);
    }
    result.map.graph.offsets.push_back(result.map.graph.targets.size());
  }
  result.map.graph.offsets.push_back(result.map.graph.targets.size());
  return result;
}

/// A ring whose edges are there from the beginning but for one, that comes at 1, and chords at random epsilons.
ErrorBoundedMap ring(Index nodes, Random& random) {
  ErrorBoundedMap result;
  for (Index node = 0; node < nodes; ++node) {
    const Index next = (node + 1) % nodes, chord = random.below(nodes);
    for (const Index target : {std::min(next, chord), std::max(next, chord)}) {
      result.map.graph.targets.push_back(target);
      result.edgeEpsilon.push_back(target != next ? random.uniform(0.9, 3.0) : next == 0 ? 1.0 : 0.0);
    }
    result.map.graph.offsets.push_back(result.map.graph.targets.size());
  }
  result.map.graph.offsets.push_back(result.map.graph.targets.size());
  return result;
}

/// The least member of each node's class.
std::vector<Index> leastMembers(const std::vector<Index>& classOf) {
  std::vector<Index> least(classOf.size(), kNone), result;
  for (std::size_t i = 0; i < classOf.size(); ++i) {
    if (least[classOf[i]] == kNone) least[classOf[i]] = static_cast<Index>(i);
    result.push_back(least[classOf[i]]);
  }
  return result;
}

/// At every epsilon the pairs so far join just the strongly connected sets, the absorbed to the least of each.
void expectComponentsOfEveryEpsilon(const ErrorBoundedMap& bounded) {
  Progress progress;
  const MergeLevels levels = mergeLevels(bounded, progress);
  ASSERT_TRUE(std::is_sorted(levels.epsilon.begin(), levels.epsilon.end()));
  std::vector<double> epsilons = bounded.edgeEpsilon;
  std::sort(epsilons.begin(), epsilons.end());
  epsilons.erase(std::unique(epsilons.begin(), epsilons.end()), epsilons.end());
  std::vector<Index> least(bounded.map.graph.nodeCount());
  std::iota(least.begin(), least.end(), 0);
  std::size_t i = 0;
  for (const double epsilon : epsilons) {
    for (; i < levels.epsilon.size() && levels.epsilon[i] <= epsilon; ++i) {
      const Index into = levels.first[i], face = levels.second[i];
      ASSERT_LT(into, face);
      ASSERT_EQ(least[into], into);
      ASSERT_EQ(least[face], face) << "absorbed twice";
      std::replace(least.begin(), least.end(), face, into);
    }
    if (epsilon == kNever) continue;
    ASSERT_EQ(least, leastMembers(stronglyConnectedComponents(mapWithinEpsilon(bounded, epsilon).graph).of)) << epsilon;
  }
  EXPECT_EQ(i, levels.epsilon.size());
}

TEST(MergeLevels, AreTheComponentsOfEveryEpsilonOfSmallGraphs) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    const Index nodes = 1 + random.below(80);
    expectComponentsOfEveryEpsilon(
        randomMap(nodes, 1 + random.below(4), 1 + random.below(nodes), random.below(4), 2 + random.below(8), random));
  }
}

TEST(MergeLevels, AreTheComponentsOfEveryEpsilonOfGraphsThatAreHalved) {
  Random random(2);
  for (int round = 0; round < 12; ++round) {
    const Index nodes = 200 + random.below(200);
    // Ties, or none; sets that merge one by one, or all at once.
    expectComponentsOfEveryEpsilon(
        randomMap(nodes, 2 + random.below(2), 1 + random.below(20), round % 3 * 20, 2 + random.below(20), random));
  }
  for (int round = 0; round < 6; ++round) expectComponentsOfEveryEpsilon(ring(150 + random.below(100), random));
}

TEST(MergeLevels, AreTheSameForAnyThreadCount) {
  // Large enough to be shared among threads; the components of a few epsilons.
  Random random(3);
  const ErrorBoundedMap bounded = randomMap(20000, 3, 40, 0, 5, random);
  Progress progress;
  const MergeLevels levels = mergeLevels(bounded, progress);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const MergeLevels again = mergeLevels(bounded, progress);
  EXPECT_EQ(levels.epsilon, again.epsilon);
  EXPECT_EQ(levels.first, again.first);
  EXPECT_EQ(levels.second, again.second);
  for (const double epsilon : {0.0, 0.2, 0.4, 0.6, 1.0}) {
    const auto joins = std::upper_bound(levels.epsilon.begin(), levels.epsilon.end(), epsilon) - levels.epsilon.begin();
    const auto parts = stronglyConnectedComponents(mapWithinEpsilon(bounded, epsilon).graph);
    EXPECT_EQ(parts.count(), bounded.map.graph.nodeCount() - joins);
    for (std::ptrdiff_t i = 0; i < joins; ++i) EXPECT_EQ(parts.of[levels.first[i]], parts.of[levels.second[i]]);
  }
}

TEST(MergeLevels, CanBeCancelled) {
  Random random(4);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(mergeLevels(randomMap(500, 3, 20, 0, 5, random), progress), Cancelled);
}

/// Sets, by node, of which some may be none.
TEST(PersistenceOf, IsOfTheSetsThatAreGiven) {
  // A path of bidirected edges 0 - 1 - 2 - 3 with epsilons 3, 1, 2: the set in the middle is none.
  MergeLevels levels{{1.0, 2.0, 3.0}, {1, 1, 0}, {2, 3, 1}};
  EXPECT_EQ(persistenceOf(levels, IndexSets({0, kNone, kNone, 1}, 2), 0.0), (std::vector<double>{3.0, 3.0}));
  EXPECT_EQ(persistenceOf(levels, IndexSets({0, 1, kNone, 2}, 3), 0.0), (std::vector<double>{3.0, 2.0, 2.0}));
  EXPECT_EQ(persistenceOf(levels, IndexSets({kNone, 0, 0, 1}, 2), 1.5), (std::vector<double>{2.0, 2.0}));
  EXPECT_EQ(persistenceOf(levels, IndexSets({kNone, kNone, kNone, 0}, 1), 0.0), std::vector<double>{kNever});
}

}  // namespace
}  // namespace stormfield::test
