#include "topology/detail/known_limit_sets.h"

#include <cmath>

namespace stormfield {
namespace {

/// Squared distance over the face's area within which a streamline that has stopped is at a fixed point.
constexpr double kNear = 1e-6;

}  // namespace

KnownLimitSets::KnownLimitSets(const TriangleMesh& mesh, const std::vector<FixedPoint>& points,
                               const std::vector<TrappingRegion>& regions)
    : mesh_(mesh),
      points_(points),
      regions_(regions),
      hasEllipse_(mesh.faceCount(), 0),
      hasSection_(mesh.edgeCount(), 0) {
  // chi = 2 components - 2 handles - boundary loops
  hasHandles_ = 2 * mesh.componentCount() - mesh.boundaryLoopCount() > mesh.eulerCharacteristic();
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (std::size_t k = 0; k < regions[i].ellipses.size(); ++k) {
      const Index face = regions[i].ellipses[k].face;
      hasEllipse_[face] = 1;
      ellipsesIn_[face].emplace_back(static_cast<Index>(i), static_cast<int>(k));
    }
  }
}

EntityRef KnownLimitSets::fixedPointTrapping(const FlatFaces& faces, const SurfacePoint& p, Direction direction) const {
  if (hasEllipse_[p.face] == 0) return {};
  for (const auto& [point, ellipse] : ellipsesIn_.at(p.face)) {
    const TrappingRegion& region = regions_[point];
    if (!(direction == Direction::Forward ? region.forward : region.backward)) continue;
    if (region.ellipses[ellipse].contains(faces[p.face].point(p.barycentric))) return {EntityKind::FixedPoint, point};
  }
  return {};
}

EntityRef KnownLimitSets::centerIn(Index face) const {
  if (hasEllipse_[face] == 0) return {};
  return {EntityKind::FixedPoint, ellipsesIn_.at(face).front().first};
}

EntityRef KnownLimitSets::fixedPointNear(const SurfacePoint& p) const {
  const Vec3 here = position(mesh_, p);
  EntityRef nearest;
  double squared = mesh_.faceArea(p.face) * kNear;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double distance = (points_[i].position - here).squaredNorm();
    if (distance > squared) continue;
    squared = distance;
    nearest = {EntityKind::FixedPoint, static_cast<Index>(i)};
  }
  return nearest;
}

std::optional<StreamlineEnd> KnownLimitSets::orbitReachedFrom(const EdgePassage& passage, Direction direction) const {
  const std::vector<Index>* sections = nullptr;
  if (passage.halfedge != kNone) {
    if (hasSection_[mesh_.edge(passage.halfedge)] == 0) return std::nullopt;
    const auto found = sectionsOn_.find(passage.halfedge);
    if (found != sectionsOn_.end()) sections = &found->second;
  } else if (passage.vertex != kNone) {
    const auto found = sectionsAt_.find(passage.vertex);
    if (found != sectionsAt_.end()) sections = &found->second;
  }
  if (sections == nullptr) return std::nullopt;
  const SideFlow wanted = direction == Direction::Forward ? SideFlow::Attracted : SideFlow::Repelled;
  for (const Index i : *sections) {
    const OrbitSection& known = sections_[i].section;
    const double position = *known.section.at(mesh_, passage);
    if (position < known.low || position > known.high) continue;
    const OrbitSide side = position < known.position ? OrbitSide::Left : OrbitSide::Right;
    const SideFlow flow = sideFlow(sections_[i].orbit, side);
    if (flow == wanted || flow == SideFlow::Closed) {
      return StreamlineEnd{{EntityKind::PeriodicOrbit, sections_[i].orbit}, side};
    }
  }
  return std::nullopt;
}

Index KnownLimitSets::orbitAt(const EdgePassage& passage, double distance) const {
  const auto& table = passage.halfedge != kNone ? sectionsOn_ : sectionsAt_;
  const auto found = table.find(passage.halfedge != kNone ? passage.halfedge : passage.vertex);
  if (found == table.end()) return kNone;
  for (const Index i : found->second) {
    const OrbitSection& known = sections_[i].section;
    if (std::abs(*known.section.at(mesh_, passage) - known.position) <= distance) return sections_[i].orbit;
  }
  return kNone;
}

Index KnownLimitSets::bandAt(Index face) const {
  const auto found = bands_.find(face);
  return found == bands_.end() ? kNone : found->second;
}

void KnownLimitSets::addOrbit(const FoundOrbit& found) {
  sides_.push_back(found.sides);
  addSection(orbitCount() - 1, found.bestSection);
}

void KnownLimitSets::addSection(Index orbit, const OrbitSection& section) {
  const auto number = static_cast<Index>(sections_.size());
  sections_.push_back({orbit, section});
  const auto& halfedges = section.section.halfedges();
  for (std::size_t i = 0; i < halfedges.size(); ++i) {
    hasSection_[mesh_.edge(halfedges[i])] = 1;
    sectionsOn_[halfedges[i]].push_back(number);
    if (i > 0) sectionsAt_[mesh_.tail(halfedges[i])].push_back(number);
  }
}

}  // namespace stormfield
