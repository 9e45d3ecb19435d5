#include "topology/detail/connection_graph.h"

#include <map>

namespace stormfield {
namespace {

bool isNode(const EntityRef& entity) {
  return entity.kind == EntityKind::FixedPoint || entity.kind == EntityKind::PeriodicOrbit;
}

class Graph {
 public:
  explicit Graph(const Topology& topology)
      : nodeReached_(topology.fixedPoints.size(), 0), sideReached_(topology.periodicOrbits.size(), {0, 0}) {}

  void link(const EntityRef& from, const EntityRef& to, Index separatrix = kNone) {
    if (!isNode(from) || !isNode(to)) return;
    auto& curves = links_[{from, to}];
    if (separatrix != kNone) curves.push_back(separatrix);
  }
  void reach(const Destinations::Arrival& end) {
    if (end.entity.kind == EntityKind::FixedPoint) nodeReached_[end.entity.index] = 1;
    if (end.entity.kind == EntityKind::PeriodicOrbit) sideReached_[end.entity.index][end.side] = 1;
  }
  bool nodeReached(Index node) const { return nodeReached_[node] != 0; }
  bool sideReached(Index orbit, int side) const { return sideReached_[orbit][side] != 0; }

  std::vector<EntityLink> links() const {
    std::vector<EntityLink> result;
    for (const auto& [ends, curves] : links_) result.push_back({ends.first, ends.second, curves});
    return result;
  }

 private:
  std::map<std::pair<EntityRef, EntityRef>, std::vector<Index>> links_;
  std::vector<char> nodeReached_;
  std::vector<std::array<char, 2>> sideReached_;
};

}  // namespace

void ConnectionEvidence::renumberOrbits(const std::vector<Index>& place) {
  for (auto& end : journeyEnds) {
    if (end.entity.kind == EntityKind::PeriodicOrbit) end.entity.index = place[end.entity.index];
  }
  for (auto& side : sides) side.orbit = place[side.orbit];
  for (auto& side : bandSides) side.orbit = place[side.orbit];
}

std::vector<EntityLink> connectionGraph(const Topology& topology, const ConnectionEvidence& evidence) {
  Graph graph(topology);
  const auto end = [&](std::size_t journey) { return evidence.journeyEnds[journey]; };
  for (std::size_t i = 0; i < evidence.separatrices.size(); ++i) {
    const auto& s = evidence.separatrices[i];
    const EntityRef saddle{EntityKind::FixedPoint, s.saddle}, other = end(s.journey).entity;
    graph.reach(end(s.journey));
    if (s.outgoing) graph.link(saddle, other, static_cast<Index>(i));
    if (!s.outgoing) graph.link(other, saddle, static_cast<Index>(i));
  }
  for (const auto& tangency : evidence.tangencies) {
    graph.reach(end(tangency.onward));
    graph.reach(end(tangency.back));
    graph.link(end(tangency.back).entity, end(tangency.onward).entity);
  }
  const Graph separated = graph;
  for (const auto& side : evidence.sides) {
    if (separated.sideReached(side.orbit, side.side)) continue;
    const EntityRef orbit{EntityKind::PeriodicOrbit, side.orbit}, other = end(side.journey).entity;
    graph.reach(end(side.journey));
    // The side's own kind says which way its journey went.
    if (side.onward) graph.link(orbit, other);
    if (!side.onward) graph.link(other, orbit);
  }
  for (const auto& side : evidence.bandSides) {
    // Just beyond the band the flow leaves it for good, or comes to it.
    const EntityRef band{EntityKind::PeriodicOrbit, side.orbit};
    const EntityRef to = end(side.onward).entity, from = end(side.back).entity;
    if (from == band && to != band) graph.link(band, to);
    if (to == band && from != band) graph.link(from, band);
  }
  for (const auto& node : evidence.nodes) {
    if (graph.nodeReached(node.node)) continue;
    const EntityRef self{EntityKind::FixedPoint, node.node}, other = end(node.journey).entity;
    // A center inside its band is linked to nothing.
    if (other.kind == EntityKind::PeriodicOrbit && topology.periodicOrbits[other.index].kind == OrbitKind::Center) {
      continue;
    }
    if (node.onward) graph.link(self, other);
    if (!node.onward) graph.link(other, self);
  }
  return graph.links();
}

}  // namespace stormfield
