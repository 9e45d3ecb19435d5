#include "edit/detail/cancel_search.h"

#include <utility>

#include "base/message.h"
#include "edit/detail/direction_fill.h"
#include "edit/detail/harmonic_fill.h"
#include "edit/detail/rotation_fill.h"
#include "edit/detail/verification.h"
#include "edit/entity_names.h"
#include "field/poincare_index.h"

namespace stormfield {
namespace {

std::string pairName(const TriangleMesh& mesh, const Topology& topology, const Interval& interval) {
  return message("the ", entityName(topology, mesh, interval.repeller), " and the ",
                 entityName(topology, mesh, interval.attractor));
}

bool isOrbit(const EntityRef& entity) {
  return entity.kind == EntityKind::PeriodicOrbit;
}

}  // namespace

std::string noRoom(const TriangleMesh& mesh, const Topology& topology, const Interval& interval) {
  return message(
      "around ", pairName(mesh, topology, interval),
      " there is no room for a change: other entities, the boundary or the rest of the surface are too near; ",
      "use a finer mesh or cancel another pair first");
}

CancelSearch::CancelSearch(const EditTask& task, const Interval& interval, const ConleyIndex& index)
    : task_(task),
      interval_(interval),
      wanted_(fewestContents(index)),
      blocks_(task.field, task.topology, interval, index, task.options.maxRings) {
  for (const Index saddle : interval.saddles) zeroFaces_.push_back(task.topology.fixedPoints[saddle].point.face);
  for (const EntityRef& entity : {interval.repeller, interval.attractor}) {
    if (!isOrbit(entity)) zeroFaces_.push_back(task.topology.fixedPoints[entity.index].point.face);
  }
  // A saddle that remains of a pair with an orbit stands where the orbit is broken.
  if (!holdsOrbit()) return;
  for (const Index s : interval.separatrices) {
    const std::vector<SurfacePoint>& points = task.topology.separatrices[s].points;
    for (const std::size_t part : {2, 3}) zeroFaces_.push_back(points[part * points.size() / 4].face);
  }
}

bool CancelSearch::holdsOrbit() const {
  return isOrbit(interval_.repeller) || isOrbit(interval_.attractor);
}

bool CancelSearch::run(EditResult& result) {
  using Try = void (CancelSearch::*)(const Block&, EditResult&);
  for (const Try tryBlock : {&CancelSearch::tryFills, &CancelSearch::tryRotations}) {
    if (tryBlock == &CancelSearch::tryRotations && !holdsOrbit()) break;
    // Turned orbits are searched anew in each field, which takes long.
    maxChecks_ =
        checks_ + (tryBlock == &CancelSearch::tryFills ? task_.options.maxChecks : task_.options.maxChecks / 2);
    for (std::size_t i = 0; checks_ < maxChecks_; ++i) {
      const Block* block = blocks_.at(i);
      if (block == nullptr) break;
      (this->*tryBlock)(*block, result);
      if (result.applied) return true;
    }
  }
  return false;
}

std::string CancelSearch::reason() const {
  if (fault_.empty()) return noRoom(task_.field.mesh(), task_.topology, interval_);
  return message("no change of the field around ", pairName(task_.field.mesh(), task_.topology, interval_),
                 " was verified: ", fault_, "; use a finer mesh or cancel another pair near them first");
}

void CancelSearch::tryFills(const Block& block, EditResult& result) {
  tryField(harmonicFill(task_.field, block.freeVertices), Fill::Harmonic, block, result);
  if (result.applied) return;
  for (VectorField& filled : directionFills(task_.field, block.freeVertices, {.zeroFaces = zeroFaces_})) {
    tryField(std::move(filled), Fill::Directions, block, result);
    if (result.applied) return;
  }
}

void CancelSearch::tryRotations(const Block& block, EditResult& result) {
  for (VectorField& filled : rotationFills(task_.field, block.freeVertices)) {
    tryField(std::move(filled), Fill::Rotation, block, result);
    if (result.applied) return;
  }
}

void CancelSearch::tryField(VectorField filled, Fill fill, const Block& block, EditResult& result) {
  if (task_.progress != nullptr) task_.progress->check();
  if (checks_ >= maxChecks_ || !hasWantedPoints(filled, block)) return;
  ++checks_;
  Topology after = updatedTopology(task_.faces, filled, task_.field, task_.topology, task_.options.topology);
  Verification found = verify(task_.field.mesh(), task_.topology, after, interval_, wanted_);
  if (!found.fault.empty()) {
    fault_ = found.fault;
    return;
  }
  accept(result, task_.field, std::move(filled), std::move(after), std::move(found.left), block.faces, fill);
}

/// Before the whole topology is found: by the indices of the block's faces.
bool CancelSearch::hasWantedPoints(const VectorField& filled, const Block& block) {
  int positive = 0, negative = 0;
  for (const Index f : block.faces) {
    const int index = poincareIndex(filled, f);
    positive += index > 0 ? 1 : 0;
    negative += index < 0 ? 1 : 0;
  }
  if (positive == wanted_.sources + wanted_.sinks && negative == wanted_.saddles) return true;
  if (fault_.empty()) {
    fault_ = message("it would leave ", describe(newPoints(filled)), " instead of ", describe(wanted_));
  }
  return false;
}

Contents CancelSearch::newPoints(const VectorField& filled) const {
  Topology points, before;
  points.fixedPoints = findFixedPoints(filled, task_.options.topology.fixedPoints);
  before.fixedPoints = task_.topology.fixedPoints;
  Contents found;
  for (const EntityRef& entity : matchEntities(filled.mesh(), before, points, interval_).unmatched) {
    found.add(points.fixedPoints[entity.index].kind);
  }
  return found;
}

}  // namespace stormfield
