// Fields with pairs to cancel, shared by the tests of edits.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "edit/cancel.h"
#include "field/poincare_index.h"
#include "topology/flows.h"

namespace stormfield::test {

/// A planar field from r' and angle' as functions of r and the angle, on a square of this half width.
inline VectorField polarField(int cells, double halfWidth,
                              const std::function<Eigen::Vector2d(double, double)>& rates) {
  return sampledOn(scaled(grid(cells, 0.2), halfWidth), [&](const Vec3& p) {
    const double r = std::hypot(p.x(), p.y()), angle = std::atan2(p.y(), p.x());
    const Eigen::Vector2d rate = rates(r, angle);
    const double radial = rate[0], around = r * rate[1];
    return Vec3(radial * std::cos(angle) - around * std::sin(angle),
                radial * std::sin(angle) + around * std::cos(angle), 0.0);
  });
}

inline std::vector<EntityRef> fixedPointsOf(const Topology& topology, FixedPointKind kind) {
  std::vector<EntityRef> result;
  for (std::size_t i = 0; i < topology.fixedPoints.size(); ++i) {
    if (topology.fixedPoints[i].kind == kind) result.push_back({EntityKind::FixedPoint, static_cast<Index>(i)});
  }
  return result;
}

inline std::vector<EntityRef> orbitsOf(const Topology& topology, OrbitKind kind) {
  std::vector<EntityRef> result;
  for (std::size_t i = 0; i < topology.periodicOrbits.size(); ++i) {
    if (topology.periodicOrbits[i].kind == kind) result.push_back({EntityKind::PeriodicOrbit, static_cast<Index>(i)});
  }
  return result;
}

inline Contents contentsOf(const Topology& topology, const std::vector<EntityRef>& entities) {
  Contents contents;
  for (const EntityRef& entity : entities) {
    if (entity.kind == EntityKind::FixedPoint) {
      contents.add(topology.fixedPoints[entity.index].kind);
    } else {
      contents.add(topology.periodicOrbits[entity.index].kind);
    }
  }
  return contents;
}

/// Of the thirteen of the thesis (figures 4.1, 4.2): D1 to D6, I1 to I7. Source and sink without a saddle are none of
/// them.
inline std::string cancellationCase(const Topology& topology, const Interval& interval) {
  const auto isOrbit = [](const EntityRef& e) { return e.kind == EntityKind::PeriodicOrbit; };
  const auto isSaddle = [&](const EntityRef& e) {
    return !isOrbit(e) && topology.fixedPoints[e.index].kind == FixedPointKind::Saddle;
  };
  const int orbits = static_cast<int>(isOrbit(interval.repeller)) + static_cast<int>(isOrbit(interval.attractor));
  const bool toSaddle = isSaddle(interval.repeller) || isSaddle(interval.attractor);
  if (interval.saddles.empty()) {
    const bool once = interval.separatrices.size() == 1;
    if (toSaddle) return orbits == 0 ? (once ? "D1" : "D5") : (once ? "D4" : "D6");
    return orbits == 2 ? "D3" : orbits == 1 ? "D2" : "node and node";
  }
  const bool two = interval.saddles.size() == 2;
  if (orbits == 0) return two ? "I1" : "I2";
  if (orbits == 2) return two ? "I6" : "I7";
  if (two) return "I3";
  const auto toOrbit = std::count_if(interval.separatrices.begin(), interval.separatrices.end(),
                                     [&](Index s) { return isOrbit(topology.separatrices[s].end); });
  return toOrbit == 2 ? "I5" : "I4";
}

/// Every pair that is linked, and every repeller and attractor with a saddle between them.
inline std::vector<std::pair<EntityRef, EntityRef>> pairsOf(const Topology& topology) {
  std::vector<std::pair<EntityRef, EntityRef>> pairs;
  for (const EntityLink& link : topology.links) pairs.emplace_back(link.source, link.target);
  for (const EntityLink& a : topology.links) {
    for (const EntityLink& b : topology.links) {
      if (a.target == b.source) pairs.emplace_back(a.source, b.target);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Poincare indices of these faces.
inline std::vector<int> poincareIndicesIn(const VectorField& field, const std::vector<Index>& faces) {
  const std::vector<int> all = poincareIndices(field);
  std::vector<int> indices;
  for (const Index f : faces) indices.push_back(all[f]);
  return indices;
}

inline int indexSum(const Topology& topology) {
  int sum = 0;
  for (const FixedPoint& p : topology.fixedPoints) sum += p.index;
  return sum;
}

}  // namespace stormfield::test
