#include "design/detail/singular_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "design/detail/pair_placement.h"

namespace stormfield {

namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();
// Pairs closer than this many edge lengths are placed with regard to the mesh.
constexpr double kCloseEdges = 4.0;
// Elements whose distance along the surface exceeds this many chords stay separate: something lies between them.
constexpr double kDetour = 2.0;
// Elements closer than this fraction of the smaller radius are at one place.
constexpr double kSamePlace = 0.1;

double meanEdge(const TriangleMesh& mesh, Index f) {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += mesh.edgeLength(mesh.edge(TriangleMesh::halfedge(f, k)));
  return sum / 3.0;
}

/// A point on the surface between a and b, about `fraction` of the distance from a.
SurfacePoint between(const TriangleMesh& mesh, const ClosestPointQuery& query, const LogMap& mapA, const LogMap& mapB,
                     double distance, double fraction) {
  const Vec3 a = position(mesh, mapA.source), b = position(mesh, mapB.source);
  const SurfacePoint onChord = query.closest(Vec3(a + fraction * (b - a))).point;
  constexpr double kStraight = 1.2;
  const double around = mapA.distance(mesh, onChord) + mapB.distance(mesh, onChord);
  if (around <= kStraight * distance + meanEdge(mesh, onChord.face)) return onChord;
  // The chord leads to another sheet of the surface: take the best vertex along the surface instead.
  Index best = mesh.vertex(mapA.source.face, 0);
  double least = kUnreached;
  for (const LogMapEntry& ea : mapA.entries) {
    const LogMapEntry* eb = mapB.find(ea.vertex);
    if (!eb) continue;
    const double cost = ea.distance + eb->distance + std::abs(ea.distance - fraction * distance);
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
    if (elements[i].type == ElementType::Singular) tracks_.push_back(makeTrack(static_cast<Index>(i), junctions));
  for (const Junction& junction : junctions) {
    if (junction.kind == Junction::Kind::Continuation) continue;
    std::vector<Index> pair;
    for (const Index i : junction.pair())
      for (std::size_t k = 0; k < tracks_.size(); ++k)
        if (tracks_[k].element == i) pair.push_back(static_cast<Index>(k));
    for (int side : {0, 1}) {
      tracks_[pair[side]].partner = pair[1 - side];
      tracks_[pair[side]].single = junction.single();
    }
    findAxis(tracks_[pair[0]], tracks_[pair[1]], junction);
  }
}

SingularTargets::SingularTrack SingularTargets::makeTrack(Index element, const std::vector<Junction>& junctions) const {
  SurfacePath path(charts_.mesh(), query_, elements_[element]);
  LambdaSpan span;
  span.start = path.start();
  span.end = path.end();
  const auto has = [&](const std::vector<Index>& side) {
    return std::find(side.begin(), side.end(), element) != side.end();
  };
  for (const Junction& junction : junctions) {
    // At the junction itself there is one element: the sample on it belongs to the single path.
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

void SingularTargets::findAxis(SingularTrack& a, SingularTrack& b, const Junction& junction) const {
  const TriangleMesh& mesh = charts_.mesh();
  const double edge = meanEdge(mesh, query_.closest(junction.point).point.face);
  const bool merge = junction.kind == Junction::Kind::Merge;
  const double otherEnd = merge ? std::max(a.span.start, b.span.start) : std::min(a.span.end, b.span.end);
  constexpr int kSteps = 2000;
  Vec3 axis = Vec3::Zero();
  for (int k = 0; k <= kSteps && axis.norm() < edge; ++k) {
    const double lambda = junction.lambda + (otherEnd - junction.lambda) * k / kSteps;
    axis = a.path.positionAt(lambda) - b.path.positionAt(lambda);
  }
  if (axis.norm() < edge)
    throw InputError(
        "\"" + elements_[a.element].name + "\" and \"" + elements_[b.element].name +
        "\" are joined but never an edge length apart: draw them along different paths, or refine the mesh");
  a.axis = axis;
  b.axis = -axis;
}

SingularState SingularTargets::stateOf(Index element, const SurfacePoint& point, double lambda) const {
  const DesignElement& e = elements_[element];
  return {point, e.kind, strengthAt(e, lambda) * charts_.mesh().size(), radiusAt(e, lambda),
          axisAngle(charts_, e, point.face, lambda)};
}

std::vector<SingularTargets::ActiveElement> SingularTargets::activeAt(double lambda, double step) const {
  std::vector<ActiveElement> active;
  for (const SingularTrack& track : tracks_) {
    const double share = track.span.share(lambda, step) * holdAt(elements_[track.element], lambda);
    if (!(share > 0.0)) continue;
    active.push_back({&track, stateOf(track.element, track.path.at(lambda), lambda), share});
  }
  return active;
}

double SingularTargets::distanceBetween(const SingularState& a, const SingularState& b, LogMapScratch& scratch) const {
  const TriangleMesh& mesh = charts_.mesh();
  const double reach = a.radius + b.radius;
  if ((position(mesh, a.point) - position(mesh, b.point)).norm() >= reach) return kUnreached;
  return recentLogMap(charts_, a.point, reach, scratch)->distance(mesh, b.point);
}

void SingularTargets::shrinkOverlapping(std::vector<ActiveElement>& active, double lambda,
                                        LogMapScratch& scratch) const {
  std::vector<double> factor(active.size(), 1.0);
  for (std::size_t i = 0; i < active.size(); ++i) {
    for (std::size_t j = i + 1; j < active.size(); ++j) {
      const ActiveElement &a = active[i], &b = active[j];
      if (a.track->partner != kNone && &tracks_[a.track->partner] == b.track) continue;
      const double distance = distanceBetween(a.state, b.state, scratch);
      const double edge = meanEdge(charts_.mesh(), a.state.point.face);
      if (distance < std::max(edge, kSamePlace * std::min(a.state.radius, b.state.radius))) {
        if (!a.track->span.contains(lambda) || !b.track->span.contains(lambda) || agree(a.state, b.state)) continue;
        throw InputError("\"" + elements_[a.track->element].name + "\" (" + name(a.state.kind) + ") and \"" +
                         elements_[b.track->element].name + "\" (" + name(b.state.kind) +
                         ") contradict each other at vertex " +
                         std::to_string(nearestVertex(charts_.mesh(), a.state.point)) + ", lambda " +
                         shortNumber(lambda) + ": move one away, or end both where a third path starts to merge them");
      }
      const double touch = distance / (a.state.radius + b.state.radius);
      factor[i] = std::min(factor[i], touch);
      factor[j] = std::min(factor[j], touch);
    }
  }
  for (std::size_t i = 0; i < active.size(); ++i) active[i].state.radius *= factor[i];
}

double SingularTargets::density(double radius) const {
  return centreDensity(stiffness_, charts_.mesh().size(), radius);
}

void SingularTargets::addDisc(const ActiveElement& active, double share, LogMapScratch& scratch,
                              std::vector<Target>& targets) const {
  const SingularState& state = active.state;
  const std::shared_ptr<const LogMap> map = recentLogMap(charts_, state.point, state.radius, scratch);
  const auto& triangles = charts_.mesh().triangles();
  for (const LogMapEntry& entry : map->entries) {
    double cover = falloff(entry.distance / state.radius);
    if ((triangles.row(state.point.face).array() == entry.vertex).any()) cover = std::max(cover, kCornerCover);
    const bool core = entry.distance < kCore * state.radius || cover == kCornerCover;
    targets.push_back({entry.vertex, singularValue(state, entry), density(state.radius) * cover * share, cover * share,
                       core, active.track->element});
  }
}

double SingularTargets::addPair(ActiveElement a, ActiveElement b, double lambda, LogMapScratch& scratch,
                                std::vector<Target>& targets) const {
  const TriangleMesh& mesh = charts_.mesh();
  const double edge = std::min(meanEdge(mesh, a.state.point.face), mesh.meanEdgeLength());
  const double chord = (position(mesh, a.state.point) - position(mesh, b.state.point)).norm();
  std::optional<PairPlacement> placed;
  if (chord < kCloseEdges * edge)
    placed = placePair(charts_, query_, a.state.point, b.state.point, a.track->axis, edge, scratch);
  if (placed) {
    a.state.point = placed->a;
    b.state.point = placed->b;
  }
  SingularPair pair{a.state, b.state, stateOf(a.track->single, a.state.point, lambda), 0.0};
  const double touching = a.state.radius + b.state.radius;
  if (chord >= touching) return 1.0;
  const double largest = std::max({a.state.radius, b.state.radius, pair.single.radius});
  const double reach = largest + std::min(touching, kDetour * chord + kCloseEdges * edge);
  const std::shared_ptr<const LogMap> mapA = recentLogMap(charts_, a.state.point, reach, scratch);
  pair.distance = mapA->distance(mesh, b.state.point);
  const double joint = pair.joint();
  if (!(joint > 0.0)) return 1.0;
  const double bothReach = pair.distance + largest;
  const std::shared_ptr<const LogMap> mapB = recentLogMap(charts_, b.state.point, bothReach, scratch);
  const double touch = a.state.radius / (a.state.radius + b.state.radius);
  const double fraction = touch + pair.closeness() * (0.5 - touch);
  const SurfacePoint saddle = placed ? placed->saddle : between(mesh, query_, *mapA, *mapB, pair.distance, fraction);
  const std::shared_ptr<const LogMap> mapSaddle = recentLogMap(charts_, saddle, bothReach, scratch);
  const double share = joint * std::min(a.share, b.share);
  // Smoothing moves three zeros a few edges apart onto each other: their weights grow as the pair closes.
  constexpr double kWeightWhenClose = 30.0;
  const double weight = 1.0 + kWeightWhenClose * pair.closeness();
  for (const PairTarget& t : pairTargets(mesh, pair, *mapA, *mapB, *mapSaddle)) {
    const bool nearerA = mapA->find(t.vertex)->distance <= mapB->find(t.vertex)->distance;
    targets.push_back({t.vertex, t.value, weight * density(t.scale) * t.cover * share, t.cover * share, t.core,
                       (nearerA ? a : b).track->element});
  }
  return 1.0 - joint;
}

void SingularTargets::addAt(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const {
  std::vector<ActiveElement> active = activeAt(lambda, step);
  shrinkOverlapping(active, lambda, scratch);
  std::vector<double> alone(active.size(), 1.0);
  for (std::size_t i = 0; i < active.size(); ++i)
    for (std::size_t j = i + 1; j < active.size(); ++j)
      if (active[i].track->partner != kNone && &tracks_[active[i].track->partner] == active[j].track)
        alone[i] = alone[j] = addPair(active[i], active[j], lambda, scratch, targets);
  for (std::size_t i = 0; i < active.size(); ++i)
    if (alone[i] > 0.0) addDisc(active[i], alone[i] * active[i].share, scratch, targets);
}

}  // namespace stormfield
