#include "edit/cancel.h"

#include <optional>
#include <set>
#include <utility>

#include "base/message.h"
#include "edit/detail/block_growth.h"
#include "edit/detail/direction_fill.h"
#include "edit/detail/harmonic_fill.h"
#include "edit/detail/interval_index.h"
#include "edit/detail/verification.h"
#include "edit/entity_names.h"

namespace stormfield {
namespace {

bool coversSurface(const TriangleMesh& mesh, const Block& block) {
  const Index component = mesh.component(mesh.vertex(block.faces.front(), 0));
  Index faces = 0;
  for (Index f = 0; f < mesh.faceCount(); ++f) faces += mesh.component(mesh.vertex(f, 0)) == component;
  return static_cast<std::size_t>(faces) == block.faces.size();
}

/// The blocks of a pair, one after the other: isolating ones, from the smallest growth on, then the others. An isolating
/// block around the interval alone has the index of the interval; one of another index is left out.
class Blocks {
 public:
  Blocks(const VectorField& field, const Topology& topology, const Interval& interval, const ConleyIndex& index,
         int maxRings)
      : mesh_(field.mesh()), growth_(field, topology, interval), index_(index) {
    for (const Walls walls : {Walls::EntitiesAndSeparatrices, Walls::Entities}) {
      for (int rings = 1; rings <= maxRings; rings += 1 + rings / 4) {
        for (const Growth growth : {Growth::Rings, Growth::Hull}) steps_.push_back({growth, rings, walls});
      }
    }
  }

  std::optional<Block> next() {
    while (step_ < steps_.size()) {
      const auto& [growth, rings, walls] = steps_[step_++];
      std::optional<Block> block = growth_.grown(growth, rings, walls);
      if (!block || block->components != 1 || coversSurface(mesh_, *block)) continue;
      if (!known_.insert(block->faces).second) continue;
      if (block->isolating && block->index == index_) return block;
      if (!block->isolating) later_.push_back(std::move(*block));
    }
    if (laterStep_ < later_.size()) return std::move(later_[laterStep_++]);
    return std::nullopt;
  }

 private:
  struct Step {
    Growth growth;
    int rings;
    Walls walls;
  };

  const TriangleMesh& mesh_;
  const BlockGrowth growth_;
  const ConleyIndex index_;
  std::vector<Step> steps_;
  std::set<std::vector<Index>> known_;
  std::vector<Block> later_;
  std::size_t step_ = 0, laterStep_ = 0;
};

std::string pairName(const TriangleMesh& mesh, const Topology& topology, const Interval& interval) {
  return message("the ", entityName(topology, mesh, interval.repeller), " and the ",
                 entityName(topology, mesh, interval.attractor));
}

std::string noRoom(const TriangleMesh& mesh, const Topology& topology, const Interval& interval) {
  return message(
      "around ", pairName(mesh, topology, interval),
      " there is no room for a change: other entities, the boundary or the rest of the surface are too near; ",
      "use a finer mesh or cancel another pair first");
}

/// One try after the other, until a field is verified.
class CancelSearch {
 public:
  CancelSearch(const FlatFaces& faces, const VectorField& field, const Topology& topology, const Interval& interval,
               const Contents& wanted, const CancelOptions& options, Progress* progress)
      : faces_(faces),
        field_(field),
        topology_(topology),
        interval_(interval),
        wanted_(wanted),
        options_(options),
        progress_(progress) {
    for (const Index saddle : interval.saddles) zeroFaces_.push_back(topology.fixedPoints[saddle].point.face);
    for (const EntityRef& entity : {interval.repeller, interval.attractor}) {
      if (entity.kind == EntityKind::FixedPoint) zeroFaces_.push_back(topology.fixedPoints[entity.index].point.face);
    }
  }

  void tryBlock(const Block& block, EditResult& result) {
    tryField(harmonicFill(field_, block.freeVertices), Fill::Harmonic, block, result);
    if (result.applied) return;
    for (VectorField& filled : directionFills(field_, block.freeVertices, {.zeroFaces = zeroFaces_})) {
      tryField(std::move(filled), Fill::Directions, block, result);
      if (result.applied) return;
    }
  }
  bool exhausted() const { return checks_ >= options_.maxChecks; }
  /// Why no try was verified.
  std::string reason() const {
    if (fault_.empty()) return noRoom(field_.mesh(), topology_, interval_);
    return message("no change of the field around ", pairName(field_.mesh(), topology_, interval_),
                   " was verified: ", fault_, "; use a finer mesh or cancel another pair near them first");
  }

 private:
  void tryField(VectorField filled, Fill fill, const Block& block, EditResult& result) {
    if (progress_ != nullptr) progress_->check();
    if (exhausted() || !hasWantedPoints(filled)) return;
    ++checks_;
    Topology after = findTopology(faces_, filled, options_.topology, nullptr);
    Verification found = verify(field_.mesh(), topology_, after, interval_, wanted_);
    if (!found.fault.empty()) {
      fault_ = found.fault;
      return;
    }
    result.applied = true;
    result.change = changeBetween(field_, filled);
    result.field = std::move(filled);
    result.topology = std::move(after);
    result.left = std::move(found.left);
    result.faces = block.faces;
    result.vertices = block.freeVertices;
    result.fill = fill;
  }

  /// Before the whole topology is found: the fixed points alone.
  bool hasWantedPoints(const VectorField& filled) {
    Topology points;
    points.fixedPoints = findFixedPoints(filled, options_.topology.fixedPoints);
    Topology before;
    before.fixedPoints = topology_.fixedPoints;
    Contents found;
    for (const EntityRef& entity : matchEntities(field_.mesh(), before, points).unmatched) {
      found.add(points.fixedPoints[entity.index].kind);
    }
    Contents wanted = wanted_;
    wanted.attractingOrbits = wanted.repellingOrbits = 0;
    if (found == wanted) return true;
    if (fault_.empty()) fault_ = message("it would leave ", describe(found), " instead of ", describe(wanted_));
    return false;
  }

  const FlatFaces& faces_;
  const VectorField& field_;
  const Topology& topology_;
  const Interval& interval_;
  const Contents wanted_;
  const CancelOptions& options_;
  Progress* progress_;
  std::vector<Index> zeroFaces_;
  int checks_ = 0;
  std::string fault_;
};

}  // namespace

CancelPlan planCancel(const VectorField& field, const Topology& topology, const EntityRef& a, const EntityRef& b,
                      const CancelOptions& options) {
  CancelPlan plan;
  plan.interval = findInterval(topology, field.mesh(), a, b);
  plan.index = intervalIndex(topology, plan.interval);
  plan.left = fewestContents(plan.index);
  const std::optional<Block> block = Blocks(field, topology, plan.interval, plan.index, options.maxRings).next();
  if (!block) throw InputError(noRoom(field.mesh(), topology, plan.interval));
  plan.faces = block->faces;
  return plan;
}

EditResult cancelPair(const FlatFaces& faces, const VectorField& field, const Topology& topology, const EntityRef& a,
                      const EntityRef& b, const CancelOptions& options, Progress* progress) {
  EditResult result;
  result.field = field;
  try {
    const Interval interval = findInterval(topology, field.mesh(), a, b);
    result.index = intervalIndex(topology, interval);
    Blocks blocks(field, topology, interval, result.index, options.maxRings);
    CancelSearch search(faces, field, topology, interval, fewestContents(result.index), options, progress);
    while (!result.applied && !search.exhausted()) {
      const std::optional<Block> block = blocks.next();
      if (!block) break;
      search.tryBlock(*block, result);
    }
    if (!result.applied) result.reason = search.reason();
  } catch (const InputError& fault) {
    result.reason = fault.what();
  }
  if (!result.applied) result.topology = topology;
  return result;
}

}  // namespace stormfield
