#include "design/detail/curve_strip.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>

namespace stormfield {

namespace {

/// Closest point of the polyline to x, found by descent from the segment `near`.
struct OnCurve {
  std::size_t segment = 0;
  double fraction = 0.0;
  double distance = 0.0;
};

OnCurve onSegment(const std::vector<Vec3>& curve, std::size_t k, const Vec3& x) {
  const Vec3 along = curve[k + 1] - curve[k];
  const double squared = along.squaredNorm();
  const double fraction = squared > 0.0 ? std::clamp((x - curve[k]).dot(along) / squared, 0.0, 1.0) : 0.0;
  return {k, fraction, (x - curve[k] - fraction * along).norm()};
}

OnCurve closestFrom(const std::vector<Vec3>& curve, bool closed, std::size_t start, const Vec3& x) {
  const std::ptrdiff_t segments = static_cast<std::ptrdiff_t>(curve.size()) - 1;
  OnCurve best = onSegment(curve, start, x);
  for (const int step : {1, -1}) {
    for (std::ptrdiff_t count = 1; count < segments; ++count) {
      std::ptrdiff_t k = static_cast<std::ptrdiff_t>(start) + step * count;
      if (closed) k = (k + segments) % segments;
      if (k < 0 || k >= segments) break;
      const OnCurve next = onSegment(curve, static_cast<std::size_t>(k), x);
      if (next.distance > best.distance) break;
      best = next;
    }
  }
  return best;
}

/// Central differences over the fine samples, unit.
std::vector<Vec3> tangents(const std::vector<Vec3>& curve, bool closed) {
  const std::size_t last = curve.size() - 1;
  std::vector<Vec3> result(curve.size());
  for (std::size_t k = 0; k <= last; ++k) {
    const std::size_t before = k > 0 ? k - 1 : closed ? last - 1 : 0, after = k < last ? k + 1 : closed ? 1 : last;
    result[k] = (curve[after] - curve[before]).normalized();
  }
  return result;
}

/// Rotates a by the smallest rotation that takes the unit vector from to the unit vector to.
Vec3 rotated(const Vec3& a, const Vec3& from, const Vec3& to) {
  const Vec3 axis = from.cross(to);
  const double cosine = from.dot(to);
  if (cosine < -0.999) return a;
  return cosine * a + axis.cross(a) + axis * (axis.dot(a) / (1.0 + cosine));
}

}  // namespace

std::vector<StripEntry> curveStrip(const VertexCharts& charts, const SurfacePath& path, double halfWidth) {
  const TriangleMesh& mesh = charts.mesh();
  const std::vector<Vec3>& curve = path.positions();
  const std::vector<Vec3> direction = tangents(curve, path.closed());
  struct Reached {
    OnCurve foot;
    bool onCurve = false, finished = false;
  };
  std::map<Index, Reached> reached;
  using Item = std::pair<double, Index>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  const auto reach = [&](Index v, std::size_t start, bool onCurve) {
    const OnCurve foot = closestFrom(curve, path.closed(), start, mesh.point(v));
    if (!onCurve && foot.distance >= halfWidth) return;
    const auto [it, isNew] = reached.try_emplace(v, Reached{foot, onCurve});
    it->second.onCurve = it->second.onCurve || onCurve;
    if (!isNew && (it->second.finished || foot.distance >= it->second.foot.distance)) return;
    it->second.foot = foot;
    queue.push({foot.distance, v});
  };
  for (std::size_t k = 0; k < curve.size(); ++k)
    for (int corner = 0; corner < 3; ++corner)
      reach(mesh.vertex(path.points()[k].face, corner), std::min(k, curve.size() - 2), true);
  while (!queue.empty()) {
    const Index v = queue.top().second;
    queue.pop();
    Reached& settled = reached.at(v);
    if (settled.finished) continue;
    settled.finished = true;
    if (settled.foot.distance >= halfWidth) continue;
    for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
      reach(mesh.head(h), settled.foot.segment, false);
      reach(mesh.tail(TriangleMesh::prev(h)), settled.foot.segment, false);
    }
  }

  std::vector<StripEntry> strip;
  for (const auto& [v, at] : reached) {
    const std::size_t k = at.foot.segment;
    const Vec3 along = (1.0 - at.foot.fraction) * direction[k] + at.foot.fraction * direction[k + 1];
    const Vec3 normal = mesh.faceNormal(path.points()[at.foot.fraction < 0.5 ? k : k + 1].face);
    const Complex tangent = charts.toTangent(v, rotated(along, normal, charts.normal(v)));
    if (!(std::abs(tangent) > 0.0)) continue;
    const Complex unit = tangent / std::abs(tangent);
    const Vec3 foot = curve[k] + at.foot.fraction * (curve[k + 1] - curve[k]);
    const double left = (std::conj(unit) * charts.toTangent(v, mesh.point(v) - foot)).imag();
    const bool beyond =
        !path.closed() && ((k == 0 && at.foot.fraction == 0.0) || (k + 2 == curve.size() && at.foot.fraction == 1.0));
    const double offset = beyond ? left : std::copysign(at.foot.distance, left);
    strip.push_back({v, at.foot.distance, offset, unit, at.onCurve});
  }
  return strip;
}

}  // namespace stormfield
