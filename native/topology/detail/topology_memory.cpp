#include "topology/detail/topology_memory.h"

#include <algorithm>

namespace stormfield {
namespace {

std::vector<char> changedFaces(const VectorField& before, const VectorField& now) {
  const TriangleMesh& mesh = now.mesh();
  std::vector<char> changed(mesh.faceCount(), 0);
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (before.values[v] == now.values[v]) continue;
    for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) changed[TriangleMesh::face(h)] = 1;
  }
  return changed;
}

bool samePoint(const SurfacePoint& a, const SurfacePoint& b) {
  return a.face == b.face && a.barycentric == b.barycentric;
}

/// Both are in face order.
std::vector<Index> pointsNow(const std::vector<FixedPoint>& before, const std::vector<FixedPoint>& now) {
  std::vector<Index> numbers(before.size(), kNone);
  for (std::size_t i = 0; i < before.size(); ++i) {
    auto at = std::lower_bound(now.begin(), now.end(), before[i].point.face,
                               [](const FixedPoint& p, Index face) { return p.point.face < face; });
    for (; at != now.end() && at->point.face == before[i].point.face; ++at) {
      if (samePoint(at->point, before[i].point) && at->kind == before[i].kind && at->jacobian == before[i].jacobian) {
        numbers[i] = static_cast<Index>(at - now.begin());
      }
    }
  }
  return numbers;
}

}  // namespace

Recollection::Recollection(const Topology& topologyBefore, const VectorField& before, const VectorField& now,
                           const std::vector<FixedPoint>& pointsFound)
    : memory_(*topologyBefore.memory),
      changed_(changedFaces(before, now)),
      pointNow_(pointsNow(topologyBefore.fixedPoints, pointsFound)),
      orbitNow_(memory_.orbits.size(), kNone) {
  for (std::size_t i = 0; i < memory_.orbits.size(); ++i) {
    const bool isolated = memory_.orbits[i].found.orbit.kind != OrbitKind::Center;
    if (isolated && isUnchanged(memory_.orbits[i].faces)) orbits_.push_back(static_cast<Index>(i));
  }
  for (std::size_t i = 0; i < memory_.streamlines.size(); ++i) {
    streamlinesFrom_[memory_.streamlines[i].seed.point.face].push_back(static_cast<Index>(i));
  }
}

std::optional<RememberedStreamline> Recollection::find(const StreamlineSeed& seed) const {
  const auto from = streamlinesFrom_.find(seed.point.face);
  if (from == streamlinesFrom_.end()) return std::nullopt;
  for (const Index i : from->second) {
    const RememberedStreamline& streamline = memory_.streamlines[i];
    if (!samePoint(streamline.seed.point, seed.point) || streamline.seed.direction != seed.direction ||
        streamline.seed.keepsPoints != seed.keepsPoints || !isUnchanged(streamline.course->faces)) {
      continue;
    }
    RememberedStreamline now = streamline;
    if (now.end.entity.kind == EntityKind::FixedPoint) now.end.entity.index = pointNow_[now.end.entity.index];
    if (now.end.entity.kind == EntityKind::PeriodicOrbit) now.end.entity.index = orbitNow_[now.end.entity.index];
    if (now.end.entity.kind != EntityKind::Boundary && now.end.entity.index == kNone) continue;
    return now;
  }
  return std::nullopt;
}

bool Recollection::isUnchanged(const std::vector<Index>& faces) const {
  return std::none_of(faces.begin(), faces.end(), [&](Index f) { return changed_[f] != 0; });
}

}  // namespace stormfield
