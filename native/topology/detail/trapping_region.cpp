#include "topology/detail/trapping_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "field/interpolation.h"
#include "topology/detail/sectors.h"

namespace stormfield {
namespace {

/// Radius of the disks of points on edges and at vertices, over the square root of the face's double area.
constexpr double kDiskRadius = 1e-3;
/// Nearer than this (barycentric) to its border, a point counts as on an edge.
constexpr double kOnBorder = 1e-6;
/// |trace| over the Jacobian's norm: below, its sign is round-off.
constexpr double kMinGrowth = 1e-9;
/// Level of the ellipse over the level that touches the face's border.
constexpr double kInsideFace = 0.998;
/// How often an ellipse is halved until the field crosses it inwards, and the directions that are tested.
constexpr int kMaxHalvings = 30, kSamples = 32;
/// How far the seed of a center lies from where the largest ellipse touches a side, as a fraction of the side.
constexpr double kBesideTouch = 0.05;

/// M with J'M + MJ = -1 (all eigenvalues of J have negative real parts).
Eigen::Matrix2d lyapunovMetric(const Eigen::Matrix2d& j) {
  Eigen::Matrix3d system;
  system << 2.0 * j(0, 0), 2.0 * j(1, 0), 0.0,  //
      j(0, 1), j(0, 0) + j(1, 1), j(1, 0),      //
      0.0, 2.0 * j(0, 1), 2.0 * j(1, 1);
  const Eigen::Vector3d m = system.fullPivLu().solve(Eigen::Vector3d(-1.0, 0.0, -1.0));
  return (Eigen::Matrix2d() << m[0], m[1], m[1], m[2]).finished();
}

/// The quadratic form that is constant along the trajectories of a linear center.
Eigen::Matrix2d centerMetric(const Eigen::Matrix2d& j) {
  const double sign = j(1, 0) > j(0, 1) ? 1.0 : -1.0, difference = 0.5 * (j(1, 1) - j(0, 0));
  return sign * (Eigen::Matrix2d() << j(1, 0), difference, difference, -j(0, 1)).finished();
}

/// The level of the quadratic form around the point whose ellipse first touches a side of the face, and where.
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

/// Whether the flow crosses the ellipse inwards at all samples; sign -1: whether it crosses outwards.
bool crossedInwards(const FaceInterpolant& local, Complex centre, const Eigen::Matrix2d& metric, double sign) {
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

void addDisks(const VectorField& field, const FixedPoint& p, TrappingRegion& region) {
  const auto sectors = sectorsAround(*field.charts, p.point);
  double radius = std::numeric_limits<double>::infinity();
  for (const Sector& sector : sectors) {
    radius = std::min(radius, kDiskRadius * std::sqrt(2.0 * field.mesh().faceArea(sector.face)));
  }
  for (const Sector& sector : sectors) {
    region.ellipses.push_back({sector.face, sector.apex, Eigen::Matrix2d::Identity() / (radius * radius)});
  }
  const Sector& first = sectors.front();
  const Complex direction = std::polar(1.0, first.from + 0.5 * std::min(first.opening, std::numbers::pi));
  const FaceInterpolant local = faceInterpolant(field, first.face);
  region.seed = pointIn(local, first.face, first.apex + 1.5 * radius * direction);
}

/// The largest ellipse around a linear center, and a seed where streamlines around it first leave the face.
TrappingRegion regionOfCenter(const FaceInterpolant& local, const FixedPoint& p, TrappingRegion region) {
  const Complex centre = local.point(p.point.barycentric);
  const Eigen::Matrix2d metric = centerMetric(p.jacobian);
  const Touch touch = firstTouch(local, centre, metric);
  region.ellipses = {{p.point.face, centre, metric / (kInsideFace * touch.level)}};
  const Complex side = local.corners[(touch.side + 1) % 3] - local.corners[touch.side];
  const double along = ((touch.point - local.corners[touch.side]) / side).real();
  const double moved =
      std::clamp(along + (along < 0.5 ? kBesideTouch : -kBesideTouch), kBesideTouch, 1.0 - kBesideTouch);
  region.seed = pointIn(local, p.point.face, local.corners[touch.side] + moved * side);
  return region;
}

/// The largest ellipse of the Lyapunov form that the field itself crosses inwards, and a seed on it.
TrappingRegion regionOfNode(const FaceInterpolant& local, const FixedPoint& p, TrappingRegion region) {
  const Complex centre = local.point(p.point.barycentric);
  const double sign = p.kind == FixedPointKind::Sink ? 1.0 : -1.0;
  Eigen::Matrix2d metric = lyapunovMetric(sign * p.jacobian);
  metric /= kInsideFace * firstTouch(local, centre, metric).level;
  for (int i = 0; i < kMaxHalvings && !crossedInwards(local, centre, metric, sign); ++i) metric *= 4.0;
  region.ellipses = {{p.point.face, centre, metric}};
  const Complex outward = (local.corners[0] + local.corners[1] + local.corners[2]) / 3.0 - centre;
  const Complex direction = std::abs(outward) > 0.0 ? outward / std::abs(outward) : Complex(1.0);
  const Eigen::Vector2d d(direction.real(), direction.imag());
  region.seed = pointIn(local, p.point.face, centre + direction / std::sqrt(d.dot(metric * d)));
  return region;
}

}  // namespace

TrappingRegion trappingRegion(const VectorField& field, const FixedPoint& p) {
  TrappingRegion region;
  if (p.index <= 0) return region;
  const bool degenerate = p.kind == FixedPointKind::Degenerate;
  // A center whose trace is more than round-off is a weak focus.
  const double growth = p.jacobian.trace(), least = kMinGrowth * p.jacobian.norm();
  region.forward = degenerate || growth < -least;
  region.backward = degenerate || growth > least;
  const bool inFace = p.point.barycentric.minCoeff() > kOnBorder;
  if (!inFace || degenerate) {
    addDisks(field, p, region);
    return region;
  }
  const FaceInterpolant local = faceInterpolant(field, p.point.face);
  return p.kind == FixedPointKind::Center ? regionOfCenter(local, p, region) : regionOfNode(local, p, region);
}

}  // namespace stormfield
