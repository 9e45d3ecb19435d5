// A combinatorial map F: a directed graph on the faces that encloses the flow (thesis 2.4, 6.2, 6.3). Where a trajectory
// leads from face a to face b, in one step of the map's kind, F has the edge a -> b. Kalies, Mischaikow and VanderVorst
// 2005 ("An algorithmic approach to chain recurrence") call it a combinatorial multivalued map and, where it encloses a
// map, an outer approximation of it.
//
//   const CombinatorialMap map = mapFromRows(std::vector<std::vector<Index>>{{0, 1}, {2}});
//   const bool leaves = *map.graph.begin(1) == map.outside();
#pragma once

#include <cstddef>
#include <vector>

#include "maps/directed_graph.h"

namespace stormfield {

/// One node per face and one more, outside(), which stands for everything beyond the boundary: flow that leaves the
/// surface has an edge to it, and it has none itself.
struct CombinatorialMap {
  DirectedGraph graph;

  Index outside() const { return graph.nodeCount() - 1; }
};

/// The map of the rows of all faces, each a range of targets that ascend.
template <typename Row>
CombinatorialMap mapFromRows(const std::vector<Row>& rows) {
  CombinatorialMap map;
  auto& [offsets, targets] = map.graph;
  offsets.reserve(rows.size() + 2);
  for (const Row& row : rows) offsets.push_back(offsets.back() + static_cast<std::size_t>(row.end() - row.begin()));
  offsets.push_back(offsets.back());  // outside leads nowhere
  targets.reserve(offsets.back());
  for (const Row& row : rows) targets.insert(targets.end(), row.begin(), row.end());
  return map;
}

}  // namespace stormfield
