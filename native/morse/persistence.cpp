#include "morse/persistence.h"

#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "morse/union_find.h"

namespace stormfield {
namespace {

/// An edge between nodes of the current part; rank: place of its epsilon among all different ones.
struct Edge {
  Index from, to, rank, id;
};

class Bisection {
 public:
  Bisection(std::size_t edges, Index never, Progress& progress)
      : never_(never), progress_(progress), level_(edges, never) {
    work_ = static_cast<double>(edges) * (std::log2(static_cast<double>(never) + 1.0) + 1.0);
  }

  /// Per edge the rank from which its ends are strongly connected, or never where earlier edges connect them.
  std::vector<Index> run(Index nodes, std::vector<Edge> edges) && {
    solve(0, never_, nodes, std::move(edges));
    progress_.check();
    return std::move(level_);
  }

 private:
  /// Parts with fewer edges are not worth a thread of their own.
  static constexpr std::size_t kGrain = 2000;

  /// Edges, between so many nodes, whose ends are strongly connected from a rank in low..high on (at never_: possibly
  /// not at all). The two halves have no edge in common.
  void solve(Index low, Index high, Index nodes, std::vector<Edge> edges) {
    if (edges.empty() || progress_.cancelled()) return;
    const std::size_t done = done_ += edges.size();
    progress_.report(static_cast<double>(done) / work_);
    if (low == high) {
      for (const Edge& edge : edges) level_[edge.id] = low;
      return;
    }
    const Index middle = low + (high - low) / 2, count = renumber(nodes, edges);
    const Components parts = stronglyConnectedComponents(graphUpTo(middle, count, edges));
    std::vector<Edge> within, between;
    for (const Edge& edge : edges) {
      const Index from = parts.of[edge.from], to = parts.of[edge.to];
      if (from != to) between.push_back({from, to, edge.rank, edge.id});
      // An edge that appears later, between ends that are connected already, adds nothing.
      if (from == to && edge.rank <= middle) within.push_back(edge);
    }
    const bool shared = edges.size() > kGrain;
    edges = {};
    const auto lower = [&] { solve(low, middle, count, std::move(within)); };
    const auto upper = [&] { solve(middle + 1, high, parts.count(), std::move(between)); };
    if (shared) {
      tbb::parallel_invoke(lower, upper);
    } else {
      lower();
      upper();
    }
  }

  /// Numbers the ends of the edges from 0 without gaps; how many they are.
  static Index renumber(Index nodes, std::vector<Edge>& edges) {
    std::vector<Index> number(nodes, kNone);
    Index count = 0;
    const auto numberOf = [&](Index node) { return number[node] == kNone ? number[node] = count++ : number[node]; };
    for (Edge& edge : edges) {
      edge.from = numberOf(edge.from);
      edge.to = numberOf(edge.to);
    }
    return count;
  }

  /// Rows may hold a target more than once, in any order: strongly connected components do not mind.
  static DirectedGraph graphUpTo(Index rank, Index nodes, const std::vector<Edge>& edges) {
    DirectedGraph graph;
    graph.offsets.assign(static_cast<std::size_t>(nodes) + 1, 0);
    for (const Edge& edge : edges) {
      if (edge.rank <= rank) ++graph.offsets[static_cast<std::size_t>(edge.from) + 1];
    }
    std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
    graph.targets.resize(graph.offsets.back());
    std::vector<std::size_t> next(graph.offsets.begin(), graph.offsets.end() - 1);
    for (const Edge& edge : edges) {
      if (edge.rank <= rank) graph.targets[next[edge.from]++] = edge.to;
    }
    return graph;
  }

  Index never_;
  std::atomic<std::size_t> done_{0};  ///< edges looked at
  double work_;                       ///< at most to look at
  Progress& progress_;
  std::vector<Index> level_;
};

}  // namespace

MergeLevels mergeLevels(const ErrorBoundedMap& bounded, Progress& progress) {
  const DirectedGraph& graph = bounded.map.graph;
  std::vector<double> epsilons;
  std::vector<Edge> edges;
  const auto isPair = [&](Index node, std::size_t e) {
    return graph.targets[e] != node && graph.targets[e] != bounded.map.outside() &&
           bounded.from[e] < std::numeric_limits<double>::infinity();
  };
  for (Index node = 0; node < graph.nodeCount(); ++node) {
    for (std::size_t e = graph.offsets[node]; e < graph.offsets[node + 1]; ++e) {
      if (isPair(node, e)) epsilons.push_back(bounded.from[e]);
    }
  }
  std::vector<double> ranks = epsilons;
  tbb::parallel_sort(ranks.begin(), ranks.end());
  progress.check();
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
  for (Index node = 0; node < graph.nodeCount(); ++node) {
    for (std::size_t e = graph.offsets[node]; e < graph.offsets[node + 1]; ++e) {
      if (!isPair(node, e)) continue;
      const Index id = static_cast<Index>(edges.size());
      const auto rank = std::lower_bound(ranks.begin(), ranks.end(), epsilons[id]) - ranks.begin();
      edges.push_back({node, graph.targets[e], static_cast<Index>(rank), id});
    }
  }
  const Index never = static_cast<Index>(ranks.size());
  const std::vector<Edge> pairs = edges;
  progress.check();
  Bisection bisection(edges.size(), never, progress);
  const std::vector<Index> level = std::move(bisection).run(graph.nodeCount(), std::move(edges));

  std::vector<Index> byLevel(pairs.size());
  std::iota(byLevel.begin(), byLevel.end(), 0);
  tbb::parallel_sort(byLevel.begin(), byLevel.end(),
                     [&](Index a, Index b) { return level[a] != level[b] ? level[a] < level[b] : a < b; });
  UnionFind joined(graph.nodeCount());
  MergeLevels result;
  for (const Index id : byLevel) {
    if (level[id] == never) break;
    if (!joined.join(pairs[id].from, pairs[id].to)) continue;
    result.epsilon.push_back(ranks[level[id]]);
    result.first.push_back(pairs[id].from);
    result.second.push_back(pairs[id].to);
  }
  return result;
}

std::vector<double> persistenceOf(const MergeLevels& levels, const FaceSets& sets, double epsilon) {
  constexpr Index kSeveral = -2;
  std::vector<double> result(sets.count(), std::numeric_limits<double>::infinity());
  std::vector<Index> holds = sets.setOf();  // per joined class: its only Morse set, or none, or several
  UnionFind joined(static_cast<Index>(holds.size()));
  for (std::size_t i = 0; i < levels.epsilon.size(); ++i) {
    const Index a = joined.find(levels.first[i]), b = joined.find(levels.second[i]);
    joined.join(a, b);
    const Index left = holds[a], right = holds[b];
    Index& both = holds[joined.find(a)];
    if (left == kNone || right == kNone || left == right) {
      both = left == kNone ? right : left;
      continue;
    }
    for (const Index set : {left, right}) {
      if (set != kSeveral) result[set] = std::max(levels.epsilon[i], epsilon);
    }
    both = kSeveral;
  }
  return result;
}

}  // namespace stormfield
