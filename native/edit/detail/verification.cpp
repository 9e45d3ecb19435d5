#include "edit/detail/verification.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "base/message.h"
#include "edit/detail/block_growth.h"
#include "edit/entity_names.h"

namespace stormfield {
namespace {

bool isNode(const EntityRef& entity) {
  return entity.kind == EntityKind::FixedPoint || entity.kind == EntityKind::PeriodicOrbit;
}

bool samePoint(const FixedPoint& a, const FixedPoint& b) {
  return a.point.face == b.point.face && a.point.barycentric == b.point.barycentric && a.kind == b.kind &&
         a.index == b.index;
}

/// Common faces as a fraction of all.
double overlap(const std::vector<Index>& a, const std::vector<Index>& b) {
  std::vector<Index> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return static_cast<double>(common.size()) / static_cast<double>(a.size() + b.size() - common.size());
}

/// Orbits of isolated kinds cross the same faces but for round-off at corners. Of a band of closed streamlines any may
/// have been found.
bool sameOrbit(const PeriodicOrbit& a, const PeriodicOrbit& b, const std::vector<Index>& facesA,
               const std::vector<Index>& facesB) {
  if (a.kind != b.kind) return false;
  return a.kind == OrbitKind::Center || overlap(facesA, facesB) > 0.8;
}

/// A graph whose interval is one node.
class Contracted {
 public:
  Contracted(const Topology& topology, const Interval& interval) {
    for (const EntityLink& link : topology.links) {
      if (interval.holds(link.source) && !interval.holds(link.target)) out_.insert(link.target);
      if (!interval.holds(link.source) && interval.holds(link.target)) in_.insert(link.source);
    }
    for (const Separatrix& s : topology.separatrices) {
      if (interval.holds({EntityKind::FixedPoint, s.saddle}) && !isNode(s.end)) {
        (s.outgoing ? out_ : in_).insert({s.end.kind, kNone});
      }
    }
  }
  /// Whether flow that came into the interval may go on to (or come from) this entity.
  bool leadsTo(const EntityRef& entity, bool forward) const {
    const EntityRef key = isNode(entity) ? entity : EntityRef{entity.kind, kNone};
    return forward ? out_.contains(key) : in_.contains(key);
  }

 private:
  std::set<EntityRef> in_, out_;
};

class Comparison {
 public:
  Comparison(const TriangleMesh& mesh, const Topology& before, const Topology& after, const Interval& changed,
             EntityMatch match)
      : mesh_(mesh),
        before_(before),
        after_(after),
        changed_(changed),
        match_(std::move(match)),
        contracted_(before, changed),
        pointsBefore_(after.fixedPoints.size(), kNone),
        orbitsBefore_(after.periodicOrbits.size(), kNone) {
    for (std::size_t i = 0; i < match_.fixedPoints.size(); ++i) {
      if (match_.fixedPoints[i] != kNone) pointsBefore_[match_.fixedPoints[i]] = static_cast<Index>(i);
    }
    for (std::size_t i = 0; i < match_.periodicOrbits.size(); ++i) {
      if (match_.periodicOrbits[i] != kNone) orbitsBefore_[match_.periodicOrbits[i]] = static_cast<Index>(i);
    }
  }

  const std::vector<EntityRef>& left() const { return match_.unmatched; }

  std::string lostEntity() const {
    for (std::size_t i = 0; i < match_.fixedPoints.size(); ++i) {
      const EntityRef entity{EntityKind::FixedPoint, static_cast<Index>(i)};
      if (match_.fixedPoints[i] == kNone && !changed_.holds(entity)) return lost(entity);
    }
    for (std::size_t i = 0; i < match_.periodicOrbits.size(); ++i) {
      const EntityRef entity{EntityKind::PeriodicOrbit, static_cast<Index>(i)};
      if (match_.periodicOrbits[i] == kNone && !changed_.holds(entity)) return lost(entity);
    }
    return "";
  }

  std::string wrongContents(const Contents& wanted) const {
    Contents found;
    for (const EntityRef& entity : left()) {
      if (entity.kind == EntityKind::FixedPoint) {
        found.add(after_.fixedPoints[entity.index].kind);
      } else {
        found.add(after_.periodicOrbits[entity.index].kind);
      }
    }
    if (found == wanted) return "";
    return message("it would leave ", describe(found), " instead of ", describe(wanted));
  }

  /// Of the saddles outside, which keep their separatrices and their order.
  std::string wrongSeparatrix() const {
    for (std::size_t saddle = 0; saddle < before_.fixedPoints.size(); ++saddle) {
      if (changed_.holds({EntityKind::FixedPoint, static_cast<Index>(saddle)})) continue;
      const auto old = separatricesOf(before_, static_cast<Index>(saddle));
      auto now = separatricesOf(after_, match_.fixedPoints[saddle]);
      for (const Separatrix* s : old) {
        // In any order, since that around a point that was moved may begin elsewhere.
        const auto same = std::find_if(now.begin(), now.end(), [&](const Separatrix* t) { return mayEnd(*s, *t); });
        if (same != now.end()) {
          now.erase(same);
          continue;
        }
        return message("a separatrix of the ",
                       entityName(before_, mesh_, {EntityKind::FixedPoint, static_cast<Index>(saddle)}),
                       " would end elsewhere");
      }
    }
    return "";
  }

  std::string wrongLink() const {
    std::set<std::pair<EntityRef, EntityRef>> now;
    for (const EntityLink& link : after_.links) now.insert({link.source, link.target});
    std::set<std::pair<EntityRef, EntityRef>> old;
    for (const EntityLink& link : before_.links) {
      if (changed_.holds(link.source) || changed_.holds(link.target)) continue;
      old.insert({link.source, link.target});
      if (!now.contains({afterOf(link.source), afterOf(link.target)})) return linkFault(before_, link, "be lost");
    }
    for (const EntityLink& link : after_.links) {
      const auto source = beforeOf(link.source), target = beforeOf(link.target);
      const bool comesIn = !isNode(source) || contracted_.leadsTo(source, false);
      const bool goesOut = !isNode(target) || contracted_.leadsTo(target, true);
      if (isNode(source) && isNode(target) && old.contains({source, target})) continue;
      if (!comesIn || !goesOut) return linkFault(after_, link, "appear");
    }
    return "";
  }

 private:
  std::string lost(const EntityRef& entity) const {
    return message("the ", entityName(before_, mesh_, entity), " would change");
  }
  std::string linkFault(const Topology& topology, const EntityLink& link, const char* what) const {
    return message("a link from the ", entityName(topology, mesh_, link.source), " to the ",
                   entityName(topology, mesh_, link.target), " would ", what);
  }
  static std::vector<const Separatrix*> separatricesOf(const Topology& topology, Index saddle) {
    std::vector<const Separatrix*> result;
    for (const Separatrix& s : topology.separatrices) {
      if (s.saddle == saddle) result.push_back(&s);
    }
    return result;
  }
  bool mayEnd(const Separatrix& old, const Separatrix& now) const {
    if (old.outgoing != now.outgoing) return false;
    if (!isNode(old.end)) return old.end.kind == now.end.kind;
    if (!changed_.holds(old.end)) return now.end == afterOf(old.end);
    if (!isNode(now.end)) return contracted_.leadsTo(now.end, old.outgoing);
    const EntityRef end = beforeOf(now.end);
    return !isNode(end) || contracted_.leadsTo(end, old.outgoing);
  }
  EntityRef afterOf(const EntityRef& entity) const {
    if (!isNode(entity)) return entity;
    const auto& numbers = entity.kind == EntityKind::FixedPoint ? match_.fixedPoints : match_.periodicOrbits;
    return {entity.kind, numbers[entity.index]};
  }
  /// None for what was not there before.
  EntityRef beforeOf(const EntityRef& entity) const {
    if (!isNode(entity)) return entity;
    const auto& numbers = entity.kind == EntityKind::FixedPoint ? pointsBefore_ : orbitsBefore_;
    return numbers[entity.index] == kNone ? EntityRef{} : EntityRef{entity.kind, numbers[entity.index]};
  }

  const TriangleMesh& mesh_;
  const Topology &before_, &after_;
  const Interval& changed_;
  const EntityMatch match_;
  const Contracted contracted_;
  std::vector<Index> pointsBefore_, orbitsBefore_;
};

}  // namespace

EntityMatch matchEntities(const TriangleMesh& mesh, const Topology& before, const Topology& after,
                          const Interval& changed) {
  EntityMatch match{std::vector<Index>(before.fixedPoints.size(), kNone),
                    std::vector<Index>(before.periodicOrbits.size(), kNone),
                    {}};
  std::vector<char> pointTaken(after.fixedPoints.size(), 0), orbitTaken(after.periodicOrbits.size(), 0);
  for (std::size_t i = 0; i < before.fixedPoints.size(); ++i) {
    if (changed.holds({EntityKind::FixedPoint, static_cast<Index>(i)})) continue;
    for (std::size_t j = 0; j < after.fixedPoints.size(); ++j) {
      if (pointTaken[j] != 0 || !samePoint(before.fixedPoints[i], after.fixedPoints[j])) continue;
      pointTaken[j] = 1;
      match.fixedPoints[i] = static_cast<Index>(j);
      break;
    }
  }
  std::vector<std::vector<Index>> facesAfter;
  for (const PeriodicOrbit& orbit : after.periodicOrbits) facesAfter.push_back(facesAlong(mesh, orbit.points));
  for (std::size_t i = 0; i < before.periodicOrbits.size(); ++i) {
    if (changed.holds({EntityKind::PeriodicOrbit, static_cast<Index>(i)})) continue;
    const std::vector<Index> faces = facesAlong(mesh, before.periodicOrbits[i].points);
    for (std::size_t j = 0; j < after.periodicOrbits.size(); ++j) {
      if (orbitTaken[j] != 0 || !sameOrbit(before.periodicOrbits[i], after.periodicOrbits[j], faces, facesAfter[j])) {
        continue;
      }
      orbitTaken[j] = 1;
      match.periodicOrbits[i] = static_cast<Index>(j);
      break;
    }
  }
  for (std::size_t j = 0; j < pointTaken.size(); ++j) {
    if (pointTaken[j] == 0) match.unmatched.push_back({EntityKind::FixedPoint, static_cast<Index>(j)});
  }
  for (std::size_t j = 0; j < orbitTaken.size(); ++j) {
    if (orbitTaken[j] == 0) match.unmatched.push_back({EntityKind::PeriodicOrbit, static_cast<Index>(j)});
  }
  return match;
}

Verification verify(const TriangleMesh& mesh, const Topology& before, const Topology& after, const Interval& changed,
                    const Contents& wanted) {
  const Comparison comparison(mesh, before, after, changed, matchEntities(mesh, before, after, changed));
  Verification result{"", comparison.left()};
  result.fault = comparison.lostEntity();
  if (result.fault.empty()) result.fault = comparison.wrongContents(wanted);
  if (result.fault.empty()) result.fault = comparison.wrongSeparatrix();
  if (result.fault.empty()) result.fault = comparison.wrongLink();
  return result;
}

Verification verifyMoved(const TriangleMesh& mesh, const Topology& before, const Topology& after, Index moved) {
  const Interval nothing;
  const EntityRef entity{EntityKind::FixedPoint, moved};
  EntityMatch match = matchEntities(mesh, before, after, {entity, entity, {}, {}});
  Verification result{"", match.unmatched};
  const FixedPoint& point = before.fixedPoints[moved];
  const bool one = match.unmatched.size() == 1 && match.unmatched[0].kind == EntityKind::FixedPoint;
  if (!one || after.fixedPoints[match.unmatched[0].index].kind != point.kind) {
    Contents wanted;
    wanted.add(point.kind);
    result.fault = Comparison(mesh, before, after, nothing, match).wrongContents(wanted);
    if (result.fault.empty()) result.fault = "another entity would change its kind";
    return result;
  }
  match.fixedPoints[moved] = match.unmatched[0].index;
  match.unmatched.clear();
  const Comparison comparison(mesh, before, after, nothing, std::move(match));
  result.fault = comparison.lostEntity();
  if (result.fault.empty()) result.fault = comparison.wrongSeparatrix();
  if (result.fault.empty()) result.fault = comparison.wrongLink();
  return result;
}

}  // namespace stormfield
