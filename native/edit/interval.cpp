#include "edit/interval.h"

#include <algorithm>
#include <limits>

#include "base/message.h"
#include "edit/entity_names.h"

namespace stormfield {
namespace {

enum class Role { Repels, Saddle, Attracts, Neither };

Role roleOf(const Topology& topology, const EntityRef& entity) {
  if (entity.kind == EntityKind::PeriodicOrbit) {
    const OrbitKind kind = topology.periodicOrbits[entity.index].kind;
    if (kind == OrbitKind::Attracting) return Role::Attracts;
    return kind == OrbitKind::Repelling ? Role::Repels : Role::Neither;
  }
  switch (topology.fixedPoints[entity.index].kind) {
    case FixedPointKind::Source:
      return Role::Repels;
    case FixedPointKind::Sink:
      return Role::Attracts;
    case FixedPointKind::Saddle:
      return Role::Saddle;
    default:
      return Role::Neither;
  }
}

void requireHyperbolic(const Topology& topology, const TriangleMesh& mesh, const EntityRef& entity) {
  if (roleOf(topology, entity) != Role::Neither) return;
  throw InputError(message("the ", entityName(topology, mesh, entity),
                           " neither attracts nor repels, so that it is no part of a pair; smooth a region around it ",
                           "instead"));
}

bool leads(const Topology& topology, const EntityRef& from, const EntityRef& to) {
  return std::any_of(topology.links.begin(), topology.links.end(),
                     [&](const EntityLink& link) { return link.source == from && link.target == to; });
}

/// The pair of a saddle and one of the two ends with the shortest separatrix between them.
std::string nearestPair(const Topology& topology, const TriangleMesh& mesh, const Interval& interval) {
  double shortest = std::numeric_limits<double>::infinity();
  std::string names;
  for (const Index s : interval.separatrices) {
    const Separatrix& separatrix = topology.separatrices[s];
    if (separatrix.length >= shortest) continue;
    shortest = separatrix.length;
    names = message("the ", entityName(topology, mesh, {EntityKind::FixedPoint, separatrix.saddle}), " and the ",
                    entityName(topology, mesh, separatrix.end));
  }
  return names;
}

}  // namespace

bool Interval::holds(const EntityRef& entity) const {
  if (entity.kind != EntityKind::FixedPoint && entity.kind != EntityKind::PeriodicOrbit) return false;
  if (entity == repeller || entity == attractor) return true;
  return entity.kind == EntityKind::FixedPoint && std::binary_search(saddles.begin(), saddles.end(), entity.index);
}

Interval findInterval(const Topology& topology, const TriangleMesh& mesh, const EntityRef& a, const EntityRef& b) {
  for (const EntityRef& entity : {a, b}) {
    requireEntity(topology, entity);
    requireHyperbolic(topology, mesh, entity);
  }
  const std::string nameA = entityName(topology, mesh, a), nameB = entityName(topology, mesh, b);
  if (a == b) throw InputError(message("the ", nameA, " was given twice; choose two entities"));
  const Role roleA = roleOf(topology, a), roleB = roleOf(topology, b);
  if (roleA == roleB) {
    throw InputError(message("the ", nameA, " and the ", nameB,
                             roleA == Role::Saddle     ? " are both saddles"
                             : roleA == Role::Attracts ? " both attract"
                                                       : " both repel",
                             "; a pair is one that repels and one that attracts, or a saddle and one of these"));
  }
  Interval interval;
  const bool ordered = roleA < roleB;
  interval.repeller = ordered ? a : b;
  interval.attractor = ordered ? b : a;
  for (std::size_t i = 0; i < topology.fixedPoints.size(); ++i) {
    const EntityRef point{EntityKind::FixedPoint, static_cast<Index>(i)};
    if (point == a || point == b) continue;
    if (leads(topology, interval.repeller, point) && leads(topology, point, interval.attractor)) {
      interval.saddles.push_back(point.index);
    }
  }
  if (interval.saddles.empty() && !leads(topology, interval.repeller, interval.attractor)) {
    throw InputError(message("no flow leads from the ", entityName(topology, mesh, interval.repeller), " to the ",
                             entityName(topology, mesh, interval.attractor), "; choose two that are linked"));
  }
  for (std::size_t s = 0; s < topology.separatrices.size(); ++s) {
    const Separatrix& separatrix = topology.separatrices[s];
    if (interval.holds({EntityKind::FixedPoint, separatrix.saddle}) && interval.holds(separatrix.end)) {
      interval.separatrices.push_back(static_cast<Index>(s));
    }
  }
  if (interval.saddles.size() > 2) {
    throw InputError(message(interval.saddles.size(), " saddles lie between the ", nameA, " and the ", nameB,
                             "; cancel ", nearestPair(topology, mesh, interval), " first"));
  }
  return interval;
}

}  // namespace stormfield
