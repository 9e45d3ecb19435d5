#include "morse/persistence.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace stormfield {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// What a node is absorbed by, kNone for nothing.
struct Absorbed {
  Index into = kNone;
  double epsilon = kNever;
};

struct Edge {
  Index from, to;
  double epsilon;
};

/// A graph whose nodes stand for contracted sets of the map's nodes, with the epsilon from which each edge is there.
struct Subgraph {
  DirectedGraph graph;
  std::vector<double> epsilons;  ///< per edge
  std::vector<Index> firsts;     ///< per node the least node of the map that it stands for; ascending
};

/// Strongly connected sets, numbered by their first nodes, with the nodes of each in a row, ascending.
struct Sets {
  std::vector<Index> of, members, place;  ///< place: of each node in the row of its set
  std::vector<std::size_t> offsets{0};

  Index count() const { return static_cast<Index>(offsets.size()) - 1; }
  Index size(Index set) const { return static_cast<Index>(offsets[set + 1] - offsets[set]); }
  const Index* begin(Index set) const { return members.data() + offsets[set]; }
  const Index* end(Index set) const { return members.data() + offsets[set + 1]; }
};

DirectedGraph graphUpTo(const Subgraph& subgraph, double epsilon) {
  DirectedGraph graph;
  graph.offsets.reserve(subgraph.graph.offsets.size());
  graph.targets.resize(subgraph.graph.edgeCount());
  std::size_t count = 0;
  for (Index node = 0; node < subgraph.graph.nodeCount(); ++node) {
    for (std::size_t e = subgraph.graph.offsets[node]; e < subgraph.graph.offsets[node + 1]; ++e) {
      graph.targets[count] = subgraph.graph.targets[e];
      count += subgraph.epsilons[e] <= epsilon ? 1 : 0;
    }
    graph.offsets.push_back(count);
  }
  graph.targets.resize(count);
  return graph;
}

Sets setsOf(const DirectedGraph& graph) {
  const Components components = stronglyConnectedComponents(graph);
  Sets sets;
  const std::size_t nodes = components.of.size();
  sets.of.resize(nodes);
  sets.place.resize(nodes);
  sets.members.resize(nodes);
  sets.offsets.reserve(static_cast<std::size_t>(components.count()) + 1);
  std::vector<Index> number(components.count(), kNone), filled(components.count(), 0);
  for (std::size_t node = 0; node < nodes; ++node) {
    const Index component = components.of[node];
    if (number[component] == kNone) {
      number[component] = sets.count();
      sets.offsets.push_back(sets.offsets.back() + components.sizes[component]);
    }
    const Index set = sets.of[node] = number[component];
    sets.place[node] = filled[component]++;
    sets.members[sets.offsets[set] + sets.place[node]] = static_cast<Index>(node);
  }
  return sets;
}

/// visit(node, target, epsilon) for the edges up to an epsilon within a set, by their nodes' places in it.
template <typename Visit>
void eachEdgeInside(const Subgraph& subgraph, const Sets& sets, Index set, double epsilon, const Visit& visit) {
  for (const Index* node = sets.begin(set); node != sets.end(set); ++node) {
    for (std::size_t e = subgraph.graph.offsets[*node]; e < subgraph.graph.offsets[*node + 1]; ++e) {
      const Index target = subgraph.graph.targets[e];
      if (subgraph.epsilons[e] <= epsilon && sets.of[target] == set) {
        visit(sets.place[*node], sets.place[target], subgraph.epsilons[e]);
      }
    }
  }
}

/// One set as a subgraph of its own, with the edges up to an epsilon.
Subgraph subgraphOf(const Subgraph& subgraph, const Sets& sets, Index set, double epsilon) {
  Subgraph result;
  result.graph.offsets.resize(static_cast<std::size_t>(sets.size(set)) + 1);
  for (const Index* node = sets.begin(set); node != sets.end(set); ++node) {
    result.firsts.push_back(subgraph.firsts[*node]);
  }
  eachEdgeInside(subgraph, sets, set, epsilon, [&](Index node, Index target, double from) {
    result.graph.targets.push_back(target);
    result.epsilons.push_back(from);
    ++result.graph.offsets[static_cast<std::size_t>(node) + 1];
  });
  std::partial_sum(result.graph.offsets.begin(), result.graph.offsets.end(), result.graph.offsets.begin());
  return result;
}

/// The sets as nodes; of several edges from one to another the first to appear.
Subgraph contracted(const DirectedGraph& graph, const std::vector<double>& epsilons, const std::vector<Index>& firsts,
                    const Sets& sets) {
  Subgraph result;
  result.graph.offsets.reserve(sets.offsets.size());
  result.firsts.reserve(sets.offsets.size());
  std::vector<std::size_t> last(sets.count(), 0);  // beyond the edge to each from the current set
  for (Index set = 0; set < sets.count(); ++set) {
    result.firsts.push_back(firsts[*sets.begin(set)]);
    const std::size_t begin = result.graph.offsets.back();
    for (const Index* node = sets.begin(set); node != sets.end(set); ++node) {
      for (std::size_t e = graph.offsets[*node]; e < graph.offsets[*node + 1]; ++e) {
        const Index target = sets.of[graph.targets[e]];
        if (target == set || epsilons[e] == kNever) continue;
        if (last[target] > begin) {
          double& epsilon = result.epsilons[last[target] - 1];
          epsilon = std::min(epsilon, epsilons[e]);
        } else {
          result.graph.targets.push_back(target);
          result.epsilons.push_back(epsilons[e]);
          last[target] = result.epsilons.size();
        }
      }
    }
    result.graph.offsets.push_back(result.graph.targets.size());
  }
  return result;
}

/// Of the epsilons beyond `base` one in the middle (infinite where there are none), and whether it is the only one.
std::pair<double, bool> middleOf(const std::vector<double>& epsilons, double base) {
  constexpr std::size_t kSample = 255;
  double least = kNever, largest = base;
  for (const double epsilon : epsilons) {
    largest = std::max(largest, epsilon);
    if (epsilon > base) least = std::min(least, epsilon);
  }
  const auto isBetween = [&](double epsilon) { return epsilon > least && epsilon < largest; };
  const auto count = static_cast<std::size_t>(std::count_if(epsilons.begin(), epsilons.end(), isBetween));
  if (count == 0) return {least, least == largest};
  std::vector<double> sample;
  const std::size_t stride = (count + kSample - 1) / kSample;
  std::size_t i = 0;
  for (const double epsilon : epsilons) {
    if (isBetween(epsilon) && i++ % stride == 0) sample.push_back(epsilon);
  }
  const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
  std::nth_element(sample.begin(), middle, sample.end());
  return {*middle, false};
}

class Merging {
 public:
  Merging(Index nodes, Progress& progress) : progress_(progress), absorbed_(nodes) {}

  std::vector<Absorbed> run(const ErrorBoundedMap& bounded) && {
    // Most large sets are there at epsilon 0.
    const Sets sets = setsOf(mapWithinEpsilon(bounded, 0.0).graph);
    progress_.check();
    std::vector<Index> nodes(bounded.map.graph.nodeCount());
    std::iota(nodes.begin(), nodes.end(), 0);
    absorb(nodes, sets, 0.0);
    solve(contracted(bounded.map.graph, bounded.edgeEpsilon, nodes, sets), 0.0);
    progress_.check();
    return std::move(absorbed_);
  }

 private:
  /// Subgraphs of at most so many nodes are solved directly.
  static constexpr Index kSmall = 64;
  /// Subgraphs of more nodes are shared among tasks, of so many sets each.
  static constexpr Index kGrain = 2000;

  /// Finds what merges beyond `base`; up to there no two nodes are strongly connected.
  void solve(Subgraph subgraph, double base) {
    if (progress_.cancelled()) return;
    const Index nodes = subgraph.graph.nodeCount();
    if (nodes <= kSmall) return solveSmall(subgraph);
    const auto [middle, isLast] = middleOf(subgraph.epsilons, base);
    if (middle == kNever) return;
    const Sets sets = setsOf(graphUpTo(subgraph, middle));
    if (isLast) return absorb(subgraph.firsts, sets, middle);
    Subgraph between = contracted(subgraph.graph, subgraph.epsilons, subgraph.firsts, sets);
    const auto lower = [&] {
      const auto solveSets = [&](const tbb::blocked_range<Index>& range) {
        for (Index set = range.begin(); set < range.end(); ++set) {
          if (sets.size(set) > 1) solve(subgraphOf(subgraph, sets, set, middle), base);
        }
      };
      const tbb::blocked_range<Index> all(0, sets.count(), kGrain);
      nodes > kGrain ? tbb::parallel_for(all, solveSets) : solveSets(all);
      subgraph = {};
    };
    const auto upper = [&] { solve(std::move(between), middle); };
    if (nodes > kGrain) {
      tbb::parallel_invoke(lower, upper);
    } else {
      lower();
      upper();
    }
  }

  /// The nodes of each set merge at one epsilon.
  void absorb(const std::vector<Index>& firsts, const Sets& sets, double epsilon) {
    for (Index set = 0; set < sets.count(); ++set) {
      const Index first = firsts[*sets.begin(set)];
      for (const Index* node = sets.begin(set) + 1; node != sets.end(set); ++node) {
        absorbed_[firsts[*node]] = {first, epsilon};
      }
    }
    report(static_cast<Index>(sets.members.size()) - sets.count());
  }

  /// Adds edge by edge to the nodes that every node reaches.
  void solveSmall(const Subgraph& subgraph) {
    const Index nodes = subgraph.graph.nodeCount();
    report(nodes - 1);
    std::vector<Edge> edges;
    for (Index node = 0; node < nodes; ++node) {
      for (std::size_t e = subgraph.graph.offsets[node]; e < subgraph.graph.offsets[node + 1]; ++e) {
        edges.push_back({node, subgraph.graph.targets[e], subgraph.epsilons[e]});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.epsilon < b.epsilon; });
    std::array<std::uint64_t, kSmall> reached;
    std::uint64_t single = 0;  // those not absorbed
    for (Index node = 0; node < nodes; ++node) single |= reached[node] = std::uint64_t{1} << node;
    const auto has = [&](Index node, Index other) { return (reached[node] >> other & 1U) != 0; };
    for (const auto& [from, to, epsilon] : edges) {
      if (has(from, to)) continue;
      const bool closes = has(to, from);
      const std::uint64_t more = reached[to];
      for (Index node = 0; node < nodes; ++node) reached[node] |= has(node, from) ? more : 0;
      if (!closes) continue;
      Index least = kNone;
      for (Index node = 0; node < nodes; ++node) {
        if ((single >> node & 1U) == 0 || !has(node, from) || !has(from, node)) continue;
        if (least == kNone) {
          least = node;
        } else {
          absorbed_[subgraph.firsts[node]] = {subgraph.firsts[least], epsilon};
          single ^= std::uint64_t{1} << node;
        }
      }
    }
  }

  void report(Index nodes) {
    const Index done = done_ += nodes;
    progress_.report(std::min(1.0, static_cast<double>(done) / static_cast<double>(absorbed_.size())));
  }

  Progress& progress_;
  std::atomic<Index> done_{0};
  std::vector<Absorbed> absorbed_;
};

}  // namespace

MergeLevels mergeLevels(const ErrorBoundedMap& bounded, Progress& progress) {
  const std::vector<Absorbed> absorbed = Merging(bounded.map.outside(), progress).run(bounded);
  // At equal epsilon the larger nodes come first: a node is absorbed after what it has absorbed itself.
  std::vector<std::pair<double, Index>> order, later;
  order.reserve(absorbed.size());
  for (Index n = bounded.map.outside() - 1; n >= 0; --n) {
    if (absorbed[n].into != kNone) (absorbed[n].epsilon == 0.0 ? order : later).emplace_back(absorbed[n].epsilon, -n);
  }
  tbb::parallel_sort(later.begin(), later.end());
  order.insert(order.end(), later.begin(), later.end());
  MergeLevels result;
  result.epsilon.reserve(order.size());
  result.first.reserve(order.size());
  result.second.reserve(order.size());
  for (const auto& [epsilon, minusNode] : order) {
    result.epsilon.push_back(epsilon);
    result.first.push_back(absorbed[-minusNode].into);
    result.second.push_back(-minusNode);
  }
  return result;
}

std::vector<double> persistenceOf(const MergeLevels& levels, const IndexSets& sets, double epsilon) {
  constexpr Index kSeveral = -2;
  std::vector<double> result(sets.count(), kNever);
  std::vector<Index> holds = sets.setOf();  // per node, with all it has absorbed: the only set, kNone, or kSeveral
  for (std::size_t i = 0; i < levels.epsilon.size(); ++i) {
    Index& both = holds[levels.first[i]];
    const Index other = holds[levels.second[i]];
    if (other == kNone || other == both) continue;
    if (both == kNone) {
      both = other;
      continue;
    }
    for (const Index set : {both, other}) {
      if (set != kSeveral) result[set] = std::max(levels.epsilon[i], epsilon);
    }
    both = kSeveral;
  }
  return result;
}

}  // namespace stormfield
