#include "maps/directed_graph.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "base/error.h"

namespace stormfield {
namespace {

/// Tarjan's search with an explicit path, because a recursive one would overflow the stack on long chains.
class Tarjan {
 public:
  explicit Tarjan(const DirectedGraph& graph)
      : graph_(graph), number_(graph.nodeCount(), kNone), lowest_(graph.nodeCount()) {
    result_.of.assign(graph.nodeCount(), kNone);
  }

  Components run() && {
    for (Index node = 0; node < graph_.nodeCount(); ++node) {
      if (number_[node] == kNone) search(node);
    }
    return std::move(result_);
  }

 private:
  struct Visit {
    Index node;
    const Index* next;  ///< first target that is not visited yet
  };

  void enter(Index node) {
    number_[node] = lowest_[node] = entered_++;
    open_.push_back(node);
    path_.push_back({node, graph_.begin(node)});
  }

  void search(Index root) {
    enter(root);
    while (!path_.empty()) {
      const Index node = path_.back().node;
      if (path_.back().next != graph_.end(node)) {
        const Index target = *path_.back().next++;
        if (number_[target] == kNone) {
          enter(target);
        } else if (result_.of[target] == kNone) {
          lowest_[node] = std::min(lowest_[node], number_[target]);
        }
        continue;
      }
      path_.pop_back();
      if (!path_.empty()) lowest_[path_.back().node] = std::min(lowest_[path_.back().node], lowest_[node]);
      if (lowest_[node] == number_[node]) close(node);
    }
  }

  /// The open nodes that were entered since the root make one component.
  void close(Index root) {
    const Index component = result_.count();
    Index size = 0, node = kNone;
    while (node != root) {
      node = open_.back();
      open_.pop_back();
      result_.of[node] = component;
      ++size;
    }
    result_.sizes.push_back(size);
    result_.recurrent.push_back(size > 1 || std::binary_search(graph_.begin(root), graph_.end(root), root) ? 1 : 0);
  }

  const DirectedGraph& graph_;
  std::vector<Index> number_, lowest_, open_;
  std::vector<Visit> path_;
  Index entered_ = 0;
  Components result_;
};

/// Nodes in an order in which every edge goes from an earlier to a later one. Throws when there is none.
std::vector<Index> topologicalOrder(const DirectedGraph& graph) {
  std::vector<Index> incoming(graph.nodeCount(), 0), order;
  for (const Index target : graph.targets) ++incoming[target];
  order.reserve(graph.nodeCount());
  for (Index node = 0; node < graph.nodeCount(); ++node) {
    if (incoming[node] == 0) order.push_back(node);
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (const Index* t = graph.begin(order[i]); t != graph.end(order[i]); ++t) {
      if (--incoming[*t] == 0) order.push_back(*t);
    }
  }
  if (static_cast<Index>(order.size()) < graph.nodeCount()) {
    throw InputError("only an acyclic graph has a transitive reduction; reduce its condensation instead");
  }
  return order;
}

constexpr Index kBlock = 512;
/// A set of nodes of one block, one bit each.
struct Bits {
  std::array<std::uint64_t, kBlock / 64> words{};

  bool has(Index i) const { return (words[i / 64] >> (i % 64) & 1U) != 0; }
  void add(Index i) { words[i / 64] |= std::uint64_t{1} << (i % 64); }
  void add(const Bits& other) {
    for (std::size_t w = 0; w < words.size(); ++w) words[w] |= other.words[w];
  }
};

}  // namespace

Components stronglyConnectedComponents(const DirectedGraph& graph) {
  return Tarjan(graph).run();
}

DirectedGraph reversed(const DirectedGraph& graph) {
  const auto nodes = static_cast<std::size_t>(graph.nodeCount());
  DirectedGraph result;
  result.offsets.assign(nodes + 1, 0);
  for (const Index target : graph.targets) ++result.offsets[static_cast<std::size_t>(target) + 1];
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  result.targets.resize(graph.edgeCount());
  std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
  // Sources in ascending order, so that the rows are ascending.
  for (Index node = 0; node < graph.nodeCount(); ++node) {
    for (const Index* t = graph.begin(node); t != graph.end(node); ++t) result.targets[next[*t]++] = node;
  }
  return result;
}

std::vector<char> reachable(const DirectedGraph& graph, const std::vector<Index>& start) {
  std::vector<char> seen(graph.nodeCount(), 0);
  std::vector<Index> open = start;
  for (const Index node : start) seen[node] = 1;
  while (!open.empty()) {
    const Index node = open.back();
    open.pop_back();
    for (const Index* t = graph.begin(node); t != graph.end(node); ++t) {
      if (seen[*t] != 0) continue;
      seen[*t] = 1;
      open.push_back(*t);
    }
  }
  return seen;
}

DirectedGraph condensation(const DirectedGraph& graph, const Components& components) {
  const Index count = components.count();
  std::vector<std::size_t> firstMember(static_cast<std::size_t>(count) + 1, 0);
  for (Index c = 0; c < count; ++c) firstMember[c + 1] = firstMember[c] + components.sizes[c];
  std::vector<Index> members(components.of.size());
  std::vector<std::size_t> next(firstMember.begin(), firstMember.end() - 1);
  for (Index node = 0; node < graph.nodeCount(); ++node) members[next[components.of[node]]++] = node;

  DirectedGraph result;
  result.offsets.reserve(static_cast<std::size_t>(count) + 1);
  std::vector<Index> lastSource(count, kNone);
  for (Index c = 0; c < count; ++c) {
    for (std::size_t m = firstMember[c]; m < firstMember[c + 1]; ++m) {
      for (const Index* t = graph.begin(members[m]); t != graph.end(members[m]); ++t) {
        const Index target = components.of[*t];
        if (target == c || lastSource[target] == c) continue;
        lastSource[target] = c;
        result.targets.push_back(target);
      }
    }
    std::sort(result.targets.begin() + static_cast<std::ptrdiff_t>(result.offsets.back()), result.targets.end());
    result.offsets.push_back(result.targets.size());
  }
  return result;
}

/// An edge is redundant when another target of its node leads to its end. Reachability is computed for one block of ends
/// at a time, in 64 bytes per node, and blocks do not depend on each other.
DirectedGraph transitiveReduction(const DirectedGraph& graph) {
  const std::vector<Index> order = topologicalOrder(graph);
  const Index nodes = graph.nodeCount();
  std::vector<char> kept(graph.edgeCount(), 0);
  tbb::parallel_for(Index{0}, (nodes + kBlock - 1) / kBlock, [&](Index block) {
    const Index first = block * kBlock;
    const auto inBlock = [&](Index node) { return node >= first && node < first + kBlock; };
    std::vector<Bits> reached(nodes);
    for (auto node = order.rbegin(); node != order.rend(); ++node) {
      Bits indirectly;
      for (const Index* t = graph.begin(*node); t != graph.end(*node); ++t) indirectly.add(reached[*t]);
      Bits& all = reached[*node] = indirectly;
      for (const Index* t = graph.begin(*node); t != graph.end(*node); ++t) {
        if (!inBlock(*t)) continue;
        kept[t - graph.targets.data()] = indirectly.has(*t - first) ? 0 : 1;
        all.add(*t - first);
      }
    }
  });

  DirectedGraph result;
  result.offsets.reserve(graph.offsets.size());
  for (Index node = 0; node < nodes; ++node) {
    for (std::size_t e = graph.offsets[node]; e < graph.offsets[node + 1]; ++e) {
      if (kept[e] != 0) result.targets.push_back(graph.targets[e]);
    }
    result.offsets.push_back(result.targets.size());
  }
  return result;
}

}  // namespace stormfield
