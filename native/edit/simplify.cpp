#include "edit/simplify.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "base/message.h"
#include "edit/detail/interval_index.h"
#include "edit/entity_names.h"
#include "maps/error_bound.h"
#include "morse/persistence.h"

namespace stormfield {
namespace {

/// At which epsilon any two nodes lie in one component.
class JoinLevels {
 public:
  JoinLevels(const VectorField& field, Progress& progress) {
    const ErrorBoundedMap bounded = errorBoundedMap(field, {}, progress);
    const MergeLevels levels = mergeLevels(bounded, progress);
    into_.assign(bounded.map.graph.nodeCount(), kNone);
    at_.assign(into_.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < levels.epsilon.size(); ++i) {
      into_[levels.second[i]] = levels.first[i];
      at_[levels.second[i]] = levels.epsilon[i];
    }
  }

  /// A node is absorbed after all that it has absorbed, so that levels rise on the way up.
  double of(Index a, Index b) const {
    double level = 0.0;
    while (a != b) {
      Index& lower = at_[a] <= at_[b] ? a : b;
      if (into_[lower] == kNone) return std::numeric_limits<double>::infinity();
      level = std::max(level, at_[lower]);
      lower = into_[lower];
    }
    return level;
  }

 private:
  std::vector<Index> into_;
  std::vector<double> at_;
};

Index faceOf(const Topology& topology, const EntityRef& entity) {
  if (entity.kind == EntityKind::FixedPoint) return topology.fixedPoints[entity.index].point.face;
  return topology.periodicOrbits[entity.index].points.front().face;
}

int entityCount(const Topology& topology) {
  return static_cast<int>(topology.fixedPoints.size() + topology.periodicOrbits.size());
}

struct Pair {
  double persistence = 0.0;  ///< mesh units per second
  double distance = 0.0;     ///< decides between pairs of one persistence
  EntityRef a, b;
  std::string name;
};

/// Whether fewer entities than before would be left.
bool makesSimpler(const Topology& topology, const TriangleMesh& mesh, const EntityLink& link) {
  try {
    const Interval interval = findInterval(topology, mesh, link.source, link.target);
    const Contents left = fewestContents(intervalIndex(topology, interval));
    const int count = left.fixedPoints() + left.attractingOrbits + left.repellingOrbits;
    return count < 2 + static_cast<int>(interval.saddles.size());
  } catch (const InputError&) {
    return false;
  }
}

/// Linked pairs by rising persistence.
std::vector<Pair> pairsOf(const TriangleMesh& mesh, const Topology& topology, const JoinLevels& levels) {
  std::vector<Pair> pairs;
  for (const EntityLink& link : topology.links) {
    if (!makesSimpler(topology, mesh, link)) continue;
    const Vec3 from = entityPlace(topology, mesh, link.source), to = entityPlace(topology, mesh, link.target);
    pairs.push_back(
        {levels.of(faceOf(topology, link.source), faceOf(topology, link.target)), (to - from).norm(), link.source,
         link.target,
         message(entityName(topology, mesh, link.source), " and ", entityName(topology, mesh, link.target))});
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return std::tie(p.persistence, p.distance, p.a, p.b) < std::tie(q.persistence, q.distance, q.a, q.b);
  });
  return pairs;
}

class Simplification {
 public:
  Simplification(const FlatFaces& faces, const VectorField& field, const Topology& topology,
                 const SimplifyOptions& options, Progress& progress)
      : faces_(faces),
        original_(field),
        options_(options),
        progress_(progress),
        unit_(meanSpeed(field)),
        levels_(field, progress),
        first_(entityCount(topology)) {
    result_.field = field;
    result_.topology = topology;
  }

  SimplifyResult run() {
    while (entityCount(result_.topology) > options_.keep && cancelNext()) {
      const int done = first_ - entityCount(result_.topology), all = std::max(1, first_ - options_.keep);
      progress_.report(static_cast<double>(done) / all);
    }
    result_.change = changeBetween(original_, result_.field);
    result_.vertices = changedVertices(original_, result_.field);
    return std::move(result_);
  }

 private:
  /// Whether a pair was cancelled. One that could not be is tried again after all others have been.
  bool cancelNext() {
    const std::vector<Pair> pairs = pairsOf(original_.mesh(), result_.topology, levels_);
    for (const bool again : {false, true}) {
      if (again && !appliedSince_) break;
      if (again) {
        refused_.clear();
        appliedSince_ = false;
      }
      for (const Pair& pair : pairs) {
        if (pair.persistence > options_.epsilon * unit_) break;
        if (!refused_.contains(pair.name) && cancel(pair)) return true;
      }
    }
    return false;
  }

  bool cancel(const Pair& pair) {
    progress_.check();
    EditResult edit = cancelPair(faces_, result_.field, result_.topology, pair.a, pair.b, options_.cancel, &progress_);
    std::string reason = edit.reason;
    if (edit.applied && changeBetween(original_, edit.field).largest > options_.epsilon * unit_) {
      reason = message("the vectors would change by more than ", options_.epsilon, " mean speeds");
    }
    result_.steps.push_back({pair.name, pair.persistence / unit_, reason.empty(), reason});
    if (!reason.empty()) {
      refused_.insert(pair.name);
      return false;
    }
    appliedSince_ = true;
    result_.field = std::move(edit.field);
    result_.topology = std::move(edit.topology);
    return true;
  }

  const FlatFaces& faces_;
  const VectorField& original_;
  const SimplifyOptions& options_;
  Progress& progress_;
  const double unit_;
  const JoinLevels levels_;
  const int first_;
  SimplifyResult result_;
  std::set<std::string> refused_;
  bool appliedSince_ = false;
};

}  // namespace

SimplifyResult simplifyField(const FlatFaces& faces, const VectorField& field, const Topology& topology,
                             const SimplifyOptions& options, Progress& progress) {
  if (!(options.epsilon >= 0.0)) {
    throw InputError(message("epsilon is ", options.epsilon, "; give a number of mean speeds from 0 on"));
  }
  if (options.keep < 0) throw InputError(message("keep is ", options.keep, "; give a number of entities from 0 on"));
  return Simplification(faces, field, topology, options, progress).run();
}

}  // namespace stormfield
