#include "edit/detail/interval_index.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace stormfield {
namespace {

/// A class of an entity in one dimension.
using Class = std::pair<EntityRef, int>;
using Row = std::vector<char>;

std::vector<int> dimensions(const Topology& topology, const EntityRef& entity) {
  if (entity.kind == EntityKind::PeriodicOrbit) {
    return topology.periodicOrbits[entity.index].kind == OrbitKind::Attracting ? std::vector{0, 1} : std::vector{1, 2};
  }
  const int index = topology.fixedPoints[entity.index].index;
  if (index < 0) return {1};
  return {topology.fixedPoints[entity.index].kind == FixedPointKind::Sink ? 0 : 2};
}

int rank(std::vector<Row> rows) {
  int result = 0;
  const std::size_t columns = rows.empty() ? 0 : rows.front().size();
  for (std::size_t c = 0; c < columns; ++c) {
    const auto pivot = std::find_if(rows.begin() + result, rows.end(), [&](const Row& row) { return row[c] != 0; });
    if (pivot == rows.end()) continue;
    std::swap(*pivot, rows[result]);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (static_cast<int>(r) == result || rows[r][c] == 0) continue;
      for (std::size_t i = 0; i < columns; ++i) rows[r][i] ^= rows[result][i];
    }
    ++result;
  }
  return result;
}

/// The classes of an interval by dimension, and the boundary of each.
class ChainComplex {
 public:
  ChainComplex(const Topology& topology, const Interval& interval) {
    add(topology, interval.repeller);
    add(topology, interval.attractor);
    for (const Index saddle : interval.saddles) add(topology, {EntityKind::FixedPoint, saddle});
    for (int d = 0; d < 2; ++d) boundary_[d].assign(count(d + 1), Row(count(d), 0));
    for (const Index s : interval.separatrices) {
      const Separatrix& separatrix = topology.separatrices[s];
      const EntityRef saddle{EntityKind::FixedPoint, separatrix.saddle};
      if (separatrix.outgoing) {
        join({saddle, 1}, {separatrix.end, 0});
      } else {
        join({separatrix.end, 2}, {saddle, 1});
      }
    }
    // Of classes that an entity does not have nothing is joined.
    if (interval.repeller.kind == EntityKind::PeriodicOrbit) join({interval.repeller, 1}, {interval.attractor, 0});
    if (interval.attractor.kind == EntityKind::PeriodicOrbit) join({interval.repeller, 2}, {interval.attractor, 1});
  }

  ConleyIndex homology() const {
    const int lower = rank(boundary_[0]), upper = rank(boundary_[1]);
    return {count(0) - lower, count(1) - lower - upper, count(2) - upper};
  }

 private:
  int count(int dimension) const { return static_cast<int>(places_[dimension].size()); }
  void add(const Topology& topology, const EntityRef& entity) {
    for (const int d : dimensions(topology, entity)) {
      places_[d].emplace(entity, places_[d].size());
    }
  }
  void join(const Class& of, const Class& with) {
    const auto from = places_[of.second].find(of.first), to = places_[with.second].find(with.first);
    if (from == places_[of.second].end() || to == places_[with.second].end()) return;
    boundary_[with.second][from->second][to->second] ^= 1;
  }

  std::map<EntityRef, std::size_t> places_[3];
  std::vector<Row> boundary_[2];
};

}  // namespace

ConleyIndex intervalIndex(const Topology& topology, const Interval& interval) {
  return ChainComplex(topology, interval).homology();
}

}  // namespace stormfield
