// A directed graph in compressed rows, and what analyses ask of it: strongly connected components (Tarjan) and the
// transitive reduction of an acyclic graph (thesis 2.4, 6.2).
//
//   const DirectedGraph graph{{0, 1, 2}, {1, 0}};  // 0 -> 1 -> 0
//   const Components parts = stronglyConnectedComponents(graph);
//   const DirectedGraph order = transitiveReduction(condensation(graph, parts));
#pragma once

#include <cstddef>
#include <vector>

#include "base/types.h"

namespace stormfield {

/// Node i has the targets from offsets[i] to offsets[i + 1], ascending and each once. offsets has one entry more than
/// there are nodes.
struct DirectedGraph {
  std::vector<std::size_t> offsets{0};
  std::vector<Index> targets;

  Index nodeCount() const { return static_cast<Index>(offsets.size()) - 1; }
  std::size_t edgeCount() const { return targets.size(); }
  const Index* begin(Index node) const { return targets.data() + offsets[node]; }
  const Index* end(Index node) const { return targets.data() + offsets[node + 1]; }
};

/// Components are numbered in reverse topological order: an edge between two of them goes from the higher number to the
/// lower one.
struct Components {
  std::vector<Index> of;        ///< component of each node
  std::vector<Index> sizes;     ///< nodes in each component
  std::vector<char> recurrent;  ///< whether the component holds a cycle: more than one node, or one with a loop

  Index count() const { return static_cast<Index>(sizes.size()); }
};

Components stronglyConnectedComponents(const DirectedGraph& graph);

/// The graph with every edge turned around.
DirectedGraph reversed(const DirectedGraph& graph);

/// Per node whether it is in `start` or can be reached from there.
std::vector<char> reachable(const DirectedGraph& graph, const std::vector<Index>& start);

/// One node per component, one edge where any edge leads from one to the other; no loops.
DirectedGraph condensation(const DirectedGraph& graph, const Components& components);

/// The fewest edges with the same reachability. The graph must be acyclic (throws InputError otherwise).
DirectedGraph transitiveReduction(const DirectedGraph& graph);

}  // namespace stormfield
