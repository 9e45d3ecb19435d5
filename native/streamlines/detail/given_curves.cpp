#include "streamlines/detail/given_curves.h"

#include <cmath>
#include <optional>

namespace stormfield {
namespace {

/// Curves that begin at one point are no obstacle to each other up to this arc length, in distances d.
constexpr double kCommonStart = 1.0;
/// A curve bends at an edge where the cosine between the normals of its two faces is smaller.
constexpr double kBend = 0.995;
/// Shortest chords that are kept, in steps: as a rule, before a bend, and to the last point.
constexpr double kMinChord = 0.75, kMinChordAtBend = 0.1, kMinLastChord = 1e-3;
/// A closed curve's last point that is nearer to its first one, in steps, is dropped.
constexpr double kMinClosing = 0.3;

/// The point p in the coordinates of face f, if it lies on it.
std::optional<SurfacePoint> inFace(const TriangleMesh& mesh, const SurfacePoint& p, Index f) {
  if (p.face == f) return p;
  SurfacePoint result{f, Eigen::Vector3d::Zero()};
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] < 1e-9) continue;
    int corner = 0;
    while (corner < 3 && mesh.vertex(f, corner) != mesh.vertex(p.face, k)) ++corner;
    if (corner == 3) return std::nullopt;
    result.barycentric[corner] = p.barycentric[k];
  }
  result.barycentric /= result.barycentric.sum();
  return result;
}

}  // namespace

std::vector<LinePoint> evenPoints(const TriangleMesh& mesh, const GivenCurve& curve, double step) {
  std::vector<LinePoint> result{{curve.points.front(), position(mesh, curve.points.front())}};
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const SurfacePoint& to = curve.points[i];
    const Vec3 target = position(mesh, to), from = result.back().position;
    const double chord = (target - from).norm();
    const bool bends =
        i + 1 < curve.points.size() && mesh.faceNormal(to.face).dot(mesh.faceNormal(curve.points[i + 1].face)) < kBend;
    const bool last = i + 1 == curve.points.size();
    if (chord < (last ? kMinLastChord : bends ? kMinChordAtBend : kMinChord) * step) continue;
    const auto start = inFace(mesh, result.back().point, to.face);
    const int pieces = start ? std::max(1, static_cast<int>(std::ceil(chord / step))) : 1;
    for (int k = 1; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      const SurfacePoint between{to.face, (1.0 - t) * start->barycentric + t * to.barycentric};
      result.push_back({between, position(mesh, between)});
    }
    result.push_back({to, target});
  }
  const auto returns = [&] { return (result.front().position - result.back().position).norm() < kMinClosing * step; };
  while (curve.closed && result.size() > 3 && returns()) result.pop_back();
  return result;
}

void addGivenCurve(std::vector<LinePoint>& points, bool closed, Index number, const LineRules& rules,
                   const std::vector<Vec3>& starts, const TriangleMesh& mesh, NearLines& lines) {
  SurfacePatch patch(mesh);
  const Vec3 start = points.front().position;
  const double together = kCommonStart * rules.distance;
  double arc = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LinePoint& p = points[i];
    if (i > 0) arc += (p.position - points[i - 1].position).norm();
    const auto isObstacle = [&](const LineSample& s) {
      if (s.line == number) return arc - s.arc > rules.distance;
      const bool sameStart = (starts[s.line] - start).norm() < 1e-6 * rules.distance;
      return !(sameStart && arc < together && s.arc < together);
    };
    if (!closed && lines.nearest(p.position, p.point.face, rules.testDistance, patch, isObstacle)) {
      points.resize(i);
      return;
    }
    lines.add({p.position, mesh.faceNormal(p.point.face), p.point.face, number, arc});
  }
}

}  // namespace stormfield
