#include "design/detail/singular_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "design/detail/pair_placement.h"

namespace stormfield {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
// Pairs closer than this many edge lengths are placed with regard to the mesh.
constexpr double kCloseEdges = 4.0;
// A way along the surface longer than this many times the chord leads around something: such storms stay separate.
constexpr double kDetour = 2.0;
// Storms closer than this part of the smaller radius share one place.
constexpr double kSamePlace = 0.1;

double meanEdge(const TriangleMesh& mesh, Index f) {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += mesh.edgeLength(mesh.edge(TriangleMesh::halfedge(f, k)));
  return sum / 3.0;
}

/// A point about `part` of the way from a to b along the surface.
SurfacePoint between(const TriangleMesh& mesh, const ClosestPointQuery& query, const LogMap& mapA, const LogMap& mapB,
                     double distance, double part) {
  const Vec3 a = position(mesh, mapA.source), b = position(mesh, mapB.source);
  const SurfacePoint onChord = query.closest(Vec3(a + part * (b - a))).point;
  constexpr double kStraight = 1.2;
  const double around = mapA.distance(mesh, onChord) + mapB.distance(mesh, onChord);
  if (around <= kStraight * distance + meanEdge(mesh, onChord.face)) return onChord;
  // The chord leads to another sheet of the surface: take the best vertex on the way along the surface.
  Index best = mesh.vertex(mapA.source.face, 0);
  double least = kFar;
  for (const LogMapEntry& ea : mapA.entries) {
    const LogMapEntry* eb = mapB.find(ea.vertex);
    if (!eb) continue;
    const double cost = ea.distance + eb->distance + std::abs(ea.distance - part * distance);
    if (cost < least) {
      least = cost;
      best = ea.vertex;
    }
  }
  return vertexPoint(mesh, best);
}

bool agree(const SingularState& a, const SingularState& b) {
  if (poincareIndex(a.kind) != poincareIndex(b.kind)) return false;
  if (a.kind == SingularKind::Saddle) return std::cos(2.0 * (a.axis - b.axis)) > 0.0;
  return (rotation(a.kind) / rotation(b.kind)).real() > 1e-6;
}

}  // namespace

SingularTargets::SingularTargets(const VertexCharts& charts, const ClosestPointQuery& query,
                                 const std::vector<DesignElement>& elements, const std::vector<Junction>& junctions,
                                 double stiffness)
    : charts_(charts), query_(query), elements_(elements), stiffness_(stiffness) {
  for (std::size_t i = 0; i < elements.size(); ++i)
    if (elements[i].type == ElementType::Singular) storms_.push_back(makeStorm(static_cast<Index>(i), junctions));
  for (const Junction& junction : junctions) {
    if (junction.kind == Junction::Kind::Continuation) continue;
    std::vector<Index> pair;
    for (const Index i : junction.pair())
      for (std::size_t k = 0; k < storms_.size(); ++k)
        if (storms_[k].element == i) pair.push_back(static_cast<Index>(k));
    for (int side : {0, 1}) {
      storms_[pair[side]].partner = pair[1 - side];
      storms_[pair[side]].single = junction.single();
    }
    findAxis(storms_[pair[0]], storms_[pair[1]], junction);
  }
}

SingularTargets::Storm SingularTargets::makeStorm(Index element, const std::vector<Junction>& junctions) const {
  SurfacePath path(charts_.mesh(), query_, elements_[element]);
  LambdaSpan span;
  span.start = path.start();
  span.end = path.end();
  const auto has = [&](const std::vector<Index>& side) {
    return std::find(side.begin(), side.end(), element) != side.end();
  };
  for (const Junction& junction : junctions) {
    // At the junction itself there is one storm: the sample on it belongs to the single path.
    const bool split = junction.kind == Junction::Kind::Split;
    if (has(junction.ending)) {
      span.endJoined = true;
      span.ownsEnd = split;
    }
    if (has(junction.starting)) {
      span.startJoined = true;
      span.ownsStart = !split;
    }
  }
  return {element, std::move(path), span, kNone, kNone, Vec3::Zero()};
}

void SingularTargets::findAxis(Storm& a, Storm& b, const Junction& junction) const {
  const TriangleMesh& mesh = charts_.mesh();
  const double edge = meanEdge(mesh, query_.closest(junction.point).point.face);
  const bool merge = junction.kind == Junction::Kind::Merge;
  const double far = merge ? std::max(a.span.start, b.span.start) : std::min(a.span.end, b.span.end);
  constexpr int kSteps = 2000;
  Vec3 axis = Vec3::Zero();
  for (int k = 0; k <= kSteps && axis.norm() < edge; ++k) {
    const double lambda = junction.lambda + (far - junction.lambda) * k / kSteps;
    axis = a.path.positionAt(lambda) - b.path.positionAt(lambda);
  }
  if (axis.norm() < edge)
    throw InputError(
        "\"" + elements_[a.element].name + "\" and \"" + elements_[b.element].name +
        "\" are joined but never an edge length apart: draw them along different ways, or refine the mesh");
  a.axis = axis;
  b.axis = -axis;
}

SingularState SingularTargets::stateOf(Index element, const SurfacePoint& point) const {
  const DesignElement& e = elements_[element];
  return {point, e.kind, e.strength * charts_.mesh().size(), e.radius, axisAngle(charts_, e, point.face)};
}

std::vector<SingularTargets::Present> SingularTargets::presentAt(double lambda, double step) const {
  std::vector<Present> present;
  for (const Storm& storm : storms_) {
    const double share = storm.span.share(lambda, step);
    if (!(share > 0.0)) continue;
    present.push_back({&storm, stateOf(storm.element, storm.path.at(lambda)), share});
  }
  return present;
}

double SingularTargets::distanceBetween(const SingularState& a, const SingularState& b, LogMapScratch& scratch) const {
  const TriangleMesh& mesh = charts_.mesh();
  const double reach = a.radius + b.radius;
  if ((position(mesh, a.point) - position(mesh, b.point)).norm() >= reach) return kFar;
  return recentLogMap(charts_, a.point, reach, scratch)->distance(mesh, b.point);
}

void SingularTargets::giveWay(std::vector<Present>& present, double lambda, LogMapScratch& scratch) const {
  std::vector<double> factor(present.size(), 1.0);
  for (std::size_t i = 0; i < present.size(); ++i) {
    for (std::size_t j = i + 1; j < present.size(); ++j) {
      const Present &a = present[i], &b = present[j];
      if (a.storm->partner != kNone && &storms_[a.storm->partner] == b.storm) continue;
      const double distance = distanceBetween(a.state, b.state, scratch);
      const double edge = meanEdge(charts_.mesh(), a.state.point.face);
      if (distance < std::max(edge, kSamePlace * std::min(a.state.radius, b.state.radius))) {
        if (!a.storm->span.contains(lambda) || !b.storm->span.contains(lambda) || agree(a.state, b.state)) continue;
        throw InputError("\"" + elements_[a.storm->element].name + "\" (" + name(a.state.kind) + ") and \"" +
                         elements_[b.storm->element].name + "\" (" + name(b.state.kind) +
                         ") contradict each other at vertex " +
                         std::to_string(nearestVertex(charts_.mesh(), a.state.point)) + ", lambda " +
                         shortNumber(lambda) + ": move one away, or end both where a third path starts to merge them");
      }
      const double touch = distance / (a.state.radius + b.state.radius);
      factor[i] = std::min(factor[i], touch);
      factor[j] = std::min(factor[j], touch);
    }
  }
  for (std::size_t i = 0; i < present.size(); ++i) present[i].state.radius *= factor[i];
}

double SingularTargets::density(double radius) const {
  const double relative = charts_.mesh().size() / radius;
  return stiffness_ * relative * relative;
}

void SingularTargets::addDisc(const Present& storm, double share, LogMapScratch& scratch,
                              std::vector<Target>& targets) const {
  constexpr double kLeastCoverOfCorners = 0.5;
  const SingularState& state = storm.state;
  const std::shared_ptr<const LogMap> map = recentLogMap(charts_, state.point, state.radius, scratch);
  const auto& triangles = charts_.mesh().triangles();
  for (const LogMapEntry& entry : map->entries) {
    double cover = falloff(entry.distance / state.radius);
    if ((triangles.row(state.point.face).array() == entry.vertex).any()) cover = std::max(cover, kLeastCoverOfCorners);
    const bool core = entry.distance < kCore * state.radius || cover == kLeastCoverOfCorners;
    targets.push_back({entry.vertex, singularValue(state, entry), density(state.radius) * cover * share, cover * share,
                       core, storm.storm->element});
  }
}

double SingularTargets::addPair(Present a, Present b, LogMapScratch& scratch, std::vector<Target>& targets) const {
  const TriangleMesh& mesh = charts_.mesh();
  const double edge = std::min(meanEdge(mesh, a.state.point.face), mesh.meanEdgeLength());
  const double chord = (position(mesh, a.state.point) - position(mesh, b.state.point)).norm();
  std::optional<PairPlacement> placed;
  if (chord < kCloseEdges * edge)
    placed = placePair(charts_, query_, a.state.point, b.state.point, a.storm->axis, edge, scratch);
  if (placed) {
    a.state.point = placed->a;
    b.state.point = placed->b;
  }
  StormPair pair{a.state, b.state, stateOf(a.storm->single, a.state.point), 0.0};
  const double touching = a.state.radius + b.state.radius;
  if (chord >= touching) return 1.0;
  const double largest = std::max({a.state.radius, b.state.radius, pair.single.radius});
  const double reach = largest + std::min(touching, kDetour * chord + kCloseEdges * edge);
  const std::shared_ptr<const LogMap> mapA = recentLogMap(charts_, a.state.point, reach, scratch);
  pair.distance = mapA->distance(mesh, b.state.point);
  const double joint = pair.joint();
  if (!(joint > 0.0)) return 1.0;
  const double far = pair.distance + largest;
  const std::shared_ptr<const LogMap> mapB = recentLogMap(charts_, b.state.point, far, scratch);
  const double touch = a.state.radius / (a.state.radius + b.state.radius);
  const double part = touch + pair.closeness() * (0.5 - touch);
  const SurfacePoint saddle = placed ? placed->saddle : between(mesh, query_, *mapA, *mapB, pair.distance, part);
  const std::shared_ptr<const LogMap> mapSaddle = recentLogMap(charts_, saddle, far, scratch);
  const double share = joint * std::min(a.share, b.share);
  // Three zeros a few edges apart stand less smoothing than one.
  constexpr double kFirmWhenClose = 30.0;
  const double firm = 1.0 + kFirmWhenClose * pair.closeness();
  for (const PairTarget& t : pairTargets(mesh, pair, *mapA, *mapB, *mapSaddle)) {
    const bool nearerA = mapA->find(t.vertex)->distance <= mapB->find(t.vertex)->distance;
    targets.push_back({t.vertex, t.value, firm * density(t.scale) * t.cover * share, t.cover * share, t.core,
                       (nearerA ? a : b).storm->element});
  }
  return 1.0 - joint;
}

void SingularTargets::addAt(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const {
  std::vector<Present> present = presentAt(lambda, step);
  giveWay(present, lambda, scratch);
  std::vector<double> alone(present.size(), 1.0);
  for (std::size_t i = 0; i < present.size(); ++i)
    for (std::size_t j = i + 1; j < present.size(); ++j)
      if (present[i].storm->partner != kNone && &storms_[present[i].storm->partner] == present[j].storm)
        alone[i] = alone[j] = addPair(present[i], present[j], scratch, targets);
  for (std::size_t i = 0; i < present.size(); ++i)
    if (alone[i] > 0.0) addDisc(present[i], alone[i] * present[i].share, scratch, targets);
}

}  // namespace stormfield
