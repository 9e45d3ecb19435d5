#include "topology/detail/entity_connection_graph.h"

#include <map>
#include <optional>
#include <utility>

namespace stormfield {
namespace {

bool isNode(const EntityRef& entity) {
  return entity.kind == EntityKind::FixedPoint || entity.kind == EntityKind::PeriodicOrbit;
}

class LinkBuilder {
 public:
  LinkBuilder(const std::vector<FixedPoint>& fixedPoints, const std::vector<PeriodicOrbit>& orbits)
      : orbits_(orbits), pointReached_(fixedPoints.size(), 0), sideReached_(orbits.size()) {}

  void addSeparatrices(const ConnectionEvidence& evidence) {
    for (std::size_t i = 0; i < evidence.separatrices.size(); ++i) {
      const auto& s = evidence.separatrices[i];
      const StreamlineEnd& end = evidence.ends[s.streamline];
      reach(end);
      link({EntityKind::FixedPoint, s.saddle}, end.entity, s.outgoing ? Direction::Forward : Direction::Backward,
           static_cast<Index>(i));
    }
  }
  void addTangencies(const ConnectionEvidence& evidence) {
    for (const auto& tangency : evidence.tangencies) {
      const StreamlineEnd &to = evidence.ends[tangency.forward], &from = evidence.ends[tangency.backward];
      reach(to);
      reach(from);
      link(from.entity, to.entity, Direction::Forward);
    }
  }
  /// Sides that no separatrix or tangency reaches. What one of them reaches does not take another's link away.
  void addOrbitSides(const ConnectionEvidence& evidence) {
    const std::vector<BothSides<char>> reachedBefore = sideReached_;
    for (const auto& side : evidence.orbitSides) {
      if (reachedBefore[side.orbit][side.side] != 0) continue;
      reach(evidence.ends[side.streamline]);
      link({EntityKind::PeriodicOrbit, side.orbit}, evidence.ends[side.streamline].entity, side.direction);
    }
  }
  /// Just beyond the band the flow leaves it, or comes to it.
  void addBandEnds(const ConnectionEvidence& evidence) {
    for (const auto& bandEnd : evidence.bandEnds) {
      const EntityRef band{EntityKind::PeriodicOrbit, bandEnd.orbit};
      const EntityRef to = evidence.ends[bandEnd.forward].entity, from = evidence.ends[bandEnd.backward].entity;
      if (from == band && to != band) link(band, to, Direction::Forward);
      if (to == band && from != band) link(from, band, Direction::Forward);
    }
  }
  void addFixedPoints(const ConnectionEvidence& evidence) {
    for (const auto& point : evidence.fixedPoints) {
      if (pointReached_[point.fixedPoint] != 0) continue;
      const EntityRef other = evidence.ends[point.streamline].entity;
      // A center inside its band is linked to nothing.
      if (other.kind == EntityKind::PeriodicOrbit && orbits_[other.index].kind == OrbitKind::Center) continue;
      link({EntityKind::FixedPoint, point.fixedPoint}, other, point.direction);
    }
  }

  std::vector<EntityLink> links() const {
    std::vector<EntityLink> result;
    for (const auto& [ends, curves] : links_) result.push_back({ends.first, ends.second, curves});
    return result;
  }

 private:
  void reach(const StreamlineEnd& end) {
    if (end.entity.kind == EntityKind::FixedPoint) pointReached_[end.entity.index] = 1;
    if (end.entity.kind == EntityKind::PeriodicOrbit) sideReached_[end.entity.index][end.side] = 1;
  }
  /// direction: of the streamline from one to the other; links go with the flow.
  void link(const EntityRef& from, const EntityRef& to, Direction direction,
            std::optional<Index> separatrix = std::nullopt) {
    if (!isNode(from) || !isNode(to)) return;
    auto& curves = links_[direction == Direction::Forward ? std::pair(from, to) : std::pair(to, from)];
    if (separatrix) curves.push_back(*separatrix);
  }

  const std::vector<PeriodicOrbit>& orbits_;
  std::map<std::pair<EntityRef, EntityRef>, std::vector<Index>> links_;
  std::vector<char> pointReached_;
  std::vector<BothSides<char>> sideReached_;
};

}  // namespace

void ConnectionEvidence::renumberOrbits(const std::vector<Index>& numbers) {
  for (StreamlineEnd& end : ends) {
    if (end.entity.kind == EntityKind::PeriodicOrbit) end.entity.index = numbers[end.entity.index];
  }
  for (OfOrbitSide& side : orbitSides) side.orbit = numbers[side.orbit];
  for (OfBandEnd& bandEnd : bandEnds) bandEnd.orbit = numbers[bandEnd.orbit];
}

std::vector<EntityLink> entityLinks(const std::vector<FixedPoint>& fixedPoints,
                                    const std::vector<PeriodicOrbit>& orbits, const ConnectionEvidence& evidence) {
  LinkBuilder builder(fixedPoints, orbits);
  builder.addSeparatrices(evidence);
  builder.addTangencies(evidence);
  builder.addOrbitSides(evidence);
  builder.addBandEnds(evidence);
  builder.addFixedPoints(evidence);
  return builder.links();
}

}  // namespace stormfield
