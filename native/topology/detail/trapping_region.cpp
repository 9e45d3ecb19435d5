#include "topology/detail/trapping_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "topology/detail/separatrix_directions.h"

namespace stormfield {
namespace {

/// Radius of the disks of points on edges and at vertices, in lengths of the face.
constexpr double kDiskRadius = 1e-3;

/// M with J'M + MJ = -1 (all eigenvalues of J have negative real parts).
Eigen::Matrix2d lyapunovMetric(const Eigen::Matrix2d& j) {
  Eigen::Matrix3d system;
  system << 2.0 * j(0, 0), 2.0 * j(1, 0), 0.0,  //
      j(0, 1), j(0, 0) + j(1, 1), j(1, 0),      //
      0.0, 2.0 * j(0, 1), 2.0 * j(1, 1);
  const Eigen::Vector3d m = system.fullPivLu().solve(Eigen::Vector3d(-1.0, 0.0, -1.0));
  return (Eigen::Matrix2d() << m[0], m[1], m[1], m[2]).finished();
}

/// The quadratic form that a rotation without growth keeps.
Eigen::Matrix2d keptMetric(const Eigen::Matrix2d& j) {
  const double sign = j(1, 0) > j(0, 1) ? 1.0 : -1.0, difference = 0.5 * (j(1, 1) - j(0, 0));
  return sign * (Eigen::Matrix2d() << j(1, 0), difference, difference, -j(0, 1)).finished();
}

/// Largest square level of the form around the point that stays on this side of a side of the face, and where it
/// touches.
struct Touch {
  double level = std::numeric_limits<double>::infinity();
  int side = 0;
  Complex point;
};
Touch firstTouch(const FaceInterpolant& local, Complex centre, const Eigen::Matrix2d& metric) {
  Touch first;
  const Eigen::Matrix2d inverse = metric.inverse();
  for (int i = 0; i < 3; ++i) {
    const Complex side = local.corners[(i + 1) % 3] - local.corners[i];
    const Complex inward = Complex(0.0, 1.0) * side / std::abs(side);
    const Eigen::Vector2d n(inward.real(), inward.imag());
    const double distance = ((centre - local.corners[i]) * std::conj(inward)).real();
    const Eigen::Vector2d along = inverse * n;
    const double spread = n.dot(along);
    const double level = distance * distance / spread;
    if (level < first.level) {
      const Eigen::Vector2d to = -distance / spread * along;
      first = {level, i, centre + Complex(to[0], to[1])};
    }
  }
  return first;
}

/// Whether all flow crosses the ellipse inwards; sign -1 for flow that goes outwards everywhere.
bool crossedInwards(const FaceInterpolant& local, Complex centre, const Eigen::Matrix2d& metric, double sign) {
  constexpr int kSamples = 32;
  const Eigen::LLT<Eigen::Matrix2d> factor(metric);
  for (int i = 0; i < kSamples; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSamples;
    const Eigen::Vector2d d = factor.matrixU().solve(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    const Complex v = sign * local.evaluate(centre + Complex(d[0], d[1]));
    if (d.dot(metric * Eigen::Vector2d(v.real(), v.imag())) >= 0.0) return false;
  }
  return true;
}

SurfacePoint pointIn(const FaceInterpolant& local, Index face, Complex p) {
  Eigen::Vector3d b = local.barycentric(p).cwiseMax(0.0);
  return {face, b / b.sum()};
}

void addDisks(const VectorField& field, const FixedPoint& p, NodeBasin& basin) {
  const auto sectors = sectorsAround(*field.charts, p.point);
  double radius = std::numeric_limits<double>::infinity();
  for (const Sector& sector : sectors) {
    radius = std::min(radius, kDiskRadius * std::sqrt(2.0 * field.mesh().faceArea(sector.face)));
  }
  for (const Sector& sector : sectors) {
    basin.parts.push_back({sector.face, sector.apex, Eigen::Matrix2d::Identity() / (radius * radius)});
  }
  const Sector& first = sectors.front();
  const Complex direction = std::polar(1.0, first.from + 0.5 * std::min(first.opening, std::numbers::pi));
  const FaceInterpolant local = faceInterpolant(field, first.face);
  basin.seed = pointIn(local, first.face, first.apex + 1.5 * radius * direction);
}

}  // namespace

NodeBasin nodeBasin(const VectorField& field, const FixedPoint& p) {
  NodeBasin basin;
  if (p.index <= 0) return basin;
  const bool degenerate = p.kind == FixedPointKind::Degenerate;
  // A center's trace decides where it is more than round-off.
  const double growth = p.jacobian.trace(), least = 1e-9 * p.jacobian.norm();
  basin.forward = degenerate || growth < -least;
  basin.backward = degenerate || growth > least;
  const bool inFace = p.point.barycentric.minCoeff() > 1e-6;
  if (!inFace || degenerate) {
    addDisks(field, p, basin);
    return basin;
  }
  const FaceInterpolant local = faceInterpolant(field, p.point.face);
  const Complex centre = local.point(p.point.barycentric);
  if (p.kind == FixedPointKind::Center) {
    const Eigen::Matrix2d metric = keptMetric(p.jacobian);
    const Touch touch = firstTouch(local, centre, metric);
    basin.parts = {{p.point.face, centre, metric / (0.998 * touch.level)}};
    const Complex side = local.corners[(touch.side + 1) % 3] - local.corners[touch.side];
    const double along = ((touch.point - local.corners[touch.side]) / side).real();
    const double moved = std::clamp(along + (along < 0.5 ? 0.05 : -0.05), 0.05, 0.95);
    basin.seed = pointIn(local, p.point.face, local.corners[touch.side] + moved * side);
    return basin;
  }
  const double sign = p.kind == FixedPointKind::Sink ? 1.0 : -1.0;
  Eigen::Matrix2d metric = lyapunovMetric(sign * p.jacobian);
  metric /= 0.998 * firstTouch(local, centre, metric).level;
  for (int i = 0; i < 30 && !crossedInwards(local, centre, metric, sign); ++i) metric *= 4.0;
  basin.parts = {{p.point.face, centre, metric}};
  const Complex outward = (local.corners[0] + local.corners[1] + local.corners[2]) / 3.0 - centre;
  const Complex direction = std::abs(outward) > 0.0 ? outward / std::abs(outward) : Complex(1.0);
  const Eigen::Vector2d d(direction.real(), direction.imag());
  basin.seed = pointIn(local, p.point.face, centre + direction / std::sqrt(d.dot(metric * d)));
  return basin;
}

}  // namespace stormfield
