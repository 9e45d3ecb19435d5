#include "edit/detail/cancel_steps.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "edit/detail/interval_index.h"
#include "edit/detail/verification.h"
#include "edit/move.h"

namespace stormfield {
namespace {

constexpr int kMaxTries = 6;   ///< of pairs
constexpr int kMaxChecks = 6;  ///< of fields for one pair
/// How far from its partner an entity that was moved stands, in mean edge lengths.
constexpr double kNear[] = {6.0, 12.0};

CancelOptions ofOneStep(CancelOptions options) {
  options.maxChecks = std::min(options.maxChecks, kMaxChecks);
  return options;
}

/// What stands at some stage between the first field and the last.
struct Stage {
  VectorField field;
  Topology topology;
  std::vector<EntityRef> inside;  ///< entities of the topology that take part
  std::vector<Index> faces;       ///< of all blocks so far, ascending
};

std::vector<Index> joined(const std::vector<Index>& a, const std::vector<Index>& b) {
  std::vector<Index> all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

std::vector<EntityRef> entitiesOf(const Interval& interval) {
  std::vector<EntityRef> entities{interval.repeller, interval.attractor};
  for (const Index saddle : interval.saddles) entities.push_back({EntityKind::FixedPoint, saddle});
  return entities;
}

Contents contentsOf(const Topology& topology, const std::vector<EntityRef>& entities) {
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

/// The stage after an edit that was applied to this one.
Stage after(const Stage& stage, EditResult edit, const Interval& changed) {
  const TriangleMesh& mesh = stage.field.mesh();
  const EntityMatch match = matchEntities(mesh, stage.topology, edit.topology, changed);
  Stage next{{}, {}, edit.left, joined(stage.faces, edit.faces)};
  for (const EntityRef& entity : stage.inside) {
    if (changed.holds(entity)) continue;
    const bool point = entity.kind == EntityKind::FixedPoint;
    const Index number = (point ? match.fixedPoints : match.periodicOrbits)[entity.index];
    next.inside.push_back({entity.kind, number});
  }
  std::sort(next.inside.begin(), next.inside.end());
  next.field = std::move(edit.field);
  next.topology = std::move(edit.topology);
  return next;
}

/// The pairs of a stage that are joined without a saddle in between.
std::vector<Interval> directPairs(const Stage& stage) {
  std::vector<Interval> pairs;
  const auto isInside = [&](const EntityRef& e) {
    return std::binary_search(stage.inside.begin(), stage.inside.end(), e);
  };
  for (const EntityLink& link : stage.topology.links) {
    if (!isInside(link.source) || !isInside(link.target)) continue;
    try {
      Interval pair = findInterval(stage.topology, stage.field.mesh(), link.source, link.target);
      if (pair.saddles.empty()) pairs.push_back(std::move(pair));
    } catch (const InputError&) {
      // No pair: one of them has no kind that attracts or repels.
    }
  }
  return pairs;
}

/// Ends with a stage that holds what is wanted and is verified against the first field.
class Steps {
 public:
  Steps(const EditTask& task, const Interval& interval, const ConleyIndex& index)
      : task_(task), interval_(interval), wanted_(fewestContents(index)), options_(ofOneStep(task.options)) {}

  bool cancelPairs(const Stage& stage, EditResult& result) {
    for (const Interval& pair : directPairs(stage)) {
      if (tries_ >= kMaxTries) return false;
      ++tries_;
      const std::optional<Stage> next = cancelled(stage, pair);
      if (next && (finish(*next, result) || cancelPairs(*next, result))) return true;
    }
    return false;
  }

  /// The moved entity has a new number.
  bool cancelMoved(const Stage& stage, EditResult& result) {
    if (stage.inside.size() != 2) return false;
    try {
      const Interval pair = findInterval(stage.topology, stage.field.mesh(), stage.inside[0], stage.inside[1]);
      const std::optional<Stage> next = cancelled(stage, pair);
      return next && finish(*next, result);
    } catch (const InputError&) {
      return false;
    }
  }

 private:
  std::optional<Stage> cancelled(const Stage& stage, const Interval& pair) const {
    const EditTask task{task_.faces, stage.field, stage.topology, options_, task_.progress};
    EditResult edit;
    if (!CancelSearch(task, pair, intervalIndex(stage.topology, pair)).run(edit)) return std::nullopt;
    return after(stage, std::move(edit), pair);
  }

  bool finish(const Stage& stage, EditResult& result) const {
    if (contentsOf(stage.topology, stage.inside) != wanted_) return false;
    Verification found = verify(task_.field.mesh(), task_.topology, stage.topology, interval_, wanted_);
    if (!found.fault.empty()) return false;
    accept(result, task_.field, stage.field, stage.topology, std::move(found.left), stage.faces, Fill::Steps);
    return true;
  }

  const EditTask& task_;
  const Interval& interval_;
  const Contents wanted_;
  const CancelOptions options_;
  int tries_ = 0;
};

Stage firstStage(const EditTask& task, const Interval& interval) {
  Stage stage{task.field, task.topology, entitiesOf(interval), {}};
  std::sort(stage.inside.begin(), stage.inside.end());
  return stage;
}

/// The first point along a curve that is this near to an entity; none where the curve begins so near.
std::optional<SurfacePoint> pointNear(const TriangleMesh& mesh, const Topology& topology, const EntityRef& entity,
                                      const std::vector<SurfacePoint>& curve, double distance) {
  std::vector<Vec3> places;
  if (entity.kind == EntityKind::FixedPoint) {
    places.push_back(topology.fixedPoints[entity.index].position);
  } else {
    for (const SurfacePoint& p : topology.periodicOrbits[entity.index].points) places.push_back(position(mesh, p));
  }
  const auto isNear = [&](const SurfacePoint& p) {
    const Vec3 at = position(mesh, p);
    return std::any_of(places.begin(), places.end(), [&](const Vec3& q) { return (q - at).norm() <= distance; });
  };
  const auto first = std::find_if(curve.begin(), curve.end(), isNear);
  if (first == curve.begin() || first == curve.end()) return std::nullopt;
  return *first;
}

}  // namespace

bool cancelInSteps(const EditTask& task, const Interval& interval, const ConleyIndex& index, EditResult& result) {
  return !interval.saddles.empty() && Steps(task, interval, index).cancelPairs(firstStage(task, interval), result);
}

bool cancelAfterMove(const EditTask& task, const Interval& interval, const ConleyIndex& index, EditResult& result) {
  if (!interval.saddles.empty() || interval.separatrices.size() != 1) return false;
  const TriangleMesh& mesh = task.field.mesh();
  const Separatrix& separatrix = task.topology.separatrices[interval.separatrices.front()];
  const EntityRef saddle{EntityKind::FixedPoint, separatrix.saddle};
  const CancelOptions options = ofOneStep(task.options);
  const std::vector<SurfacePoint> back(separatrix.points.rbegin(), separatrix.points.rend());
  for (const double near : kNear) {
    const double distance = near * mesh.meanEdgeLength();
    for (const bool moveSaddle : {true, false}) {
      const EntityRef moved = moveSaddle ? saddle : separatrix.end, other = moveSaddle ? separatrix.end : saddle;
      if (moved.kind != EntityKind::FixedPoint) continue;
      const auto target = pointNear(mesh, task.topology, other, moveSaddle ? separatrix.points : back, distance);
      if (!target) continue;
      EditResult edit = movePoint(task.faces, task.field, task.topology, moved.index, *target, options, task.progress);
      if (!edit.applied) continue;
      const Stage next = after(firstStage(task, interval), std::move(edit), {moved, moved, {}, {}});
      if (Steps(task, interval, index).cancelMoved(next, result)) return true;
    }
  }
  return false;
}

}  // namespace stormfield
