#include "morse/morse_connection_graph.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <unordered_map>
#include <utility>

namespace stormfield {
namespace {

/// Sets of Morse sets, each stored once under a number, with their unions: neighbouring nodes lead to the same Morse
/// sets, so that there are far fewer different ones than nodes.
class SharedSets {
 public:
  static constexpr Index kEmpty = 0;

  Index single(Index element) { return number({element}); }

  Index unite(Index a, Index b) {
    if (a == b || b == kEmpty) return a;
    if (a == kEmpty) return b;
    if (a > b) std::swap(a, b);
    const std::uint64_t key = static_cast<std::uint64_t>(a) << 32U | static_cast<std::uint64_t>(b);
    const auto known = unions_.find(key);
    if (known != unions_.end()) return known->second;
    std::vector<Index> both;
    std::set_union(elements(a).begin(), elements(a).end(), elements(b).begin(), elements(b).end(),
                   std::back_inserter(both));
    return unions_[key] = number(std::move(both));
  }

  const std::vector<Index>& elements(Index set) const { return *sets_[set]; }

 private:
  Index number(std::vector<Index> elements) {
    const auto [at, added] = numbers_.try_emplace(std::move(elements), static_cast<Index>(sets_.size()));
    if (added) sets_.push_back(&at->first);
    return at->second;
  }

  std::map<std::vector<Index>, Index> numbers_{{{}, kEmpty}};
  std::vector<const std::vector<Index>*> sets_{&numbers_.begin()->first};
  std::unordered_map<std::uint64_t, Index> unions_;
};

/// The nodes of each component, one after the other.
struct Members {
  std::vector<std::size_t> first;
  std::vector<Index> nodes;

  explicit Members(const Components& components)
      : first(static_cast<std::size_t>(components.count()) + 1, 0), nodes(components.of.size()) {
    for (Index c = 0; c < components.count(); ++c) first[c + 1] = first[c] + components.sizes[c];
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t node = 0; node < nodes.size(); ++node) {
      nodes[next[components.of[node]]++] = static_cast<Index>(node);
    }
  }
};

/// Per Morse set those that F leads to without passing through others, and outside as number sets.count().
DirectedGraph nextSets(const CombinatorialMap& map, const Components& components, const IndexSets& sets) {
  const Members members(components);
  SharedSets shared;
  // Components are numbered so that each leads to lower ones.
  std::vector<Index> leadsTo(components.count(), SharedSets::kEmpty), beyond(sets.count(), SharedSets::kEmpty);
  for (Index c = 0; c < components.count(); ++c) {
    Index all = SharedSets::kEmpty;
    for (std::size_t m = members.first[c]; m < members.first[c + 1]; ++m) {
      for (const Index* t = map.graph.begin(members.nodes[m]); t != map.graph.end(members.nodes[m]); ++t) {
        if (components.of[*t] != c) all = shared.unite(all, leadsTo[components.of[*t]]);
      }
    }
    const Index node = members.nodes[members.first[c]];
    const Index set = node == map.outside() ? sets.count() : sets.setOf(node);
    if (set != kNone && set < sets.count()) beyond[set] = all;
    leadsTo[c] = set == kNone ? all : shared.single(set);
  }
  DirectedGraph result;
  for (const Index all : beyond) {
    result.targets.insert(result.targets.end(), shared.elements(all).begin(), shared.elements(all).end());
    result.offsets.push_back(result.targets.size());
  }
  result.offsets.push_back(result.targets.size());
  return result;
}

}  // namespace

MorseConnectionGraph morseConnectionGraph(const CombinatorialMap& map, const Components& components,
                                          const IndexSets& sets) {
  const DirectedGraph next = nextSets(map, components, sets);
  const DirectedGraph least = transitiveReduction(next);
  MorseConnectionGraph result;
  for (Index a = 0; a < sets.count(); ++a) {
    for (const Index* b = least.begin(a); b != least.end(a); ++b) {
      if (*b < sets.count()) result.edges.push_back({a, *b});
    }
  }
  result.outflow = reachable(reversed(next), {sets.count()});
  result.outflow.pop_back();
  return result;
}

std::vector<Index> connectionRegion(const CombinatorialMap& map, const IndexSets& sets, Index from, Index to) {
  const std::vector<char> after = reachable(map.graph, sets.members(from));
  const std::vector<char> before = reachable(reversed(map.graph), sets.members(to));
  std::vector<Index> result;
  for (Index node = 0; node < map.outside(); ++node) {
    const bool between = after[node] != 0 && before[node] != 0;
    if (between && sets.setOf(node) != from && sets.setOf(node) != to) result.push_back(node);
  }
  return result;
}

}  // namespace stormfield
