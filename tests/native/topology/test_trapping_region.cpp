#include "topology/detail/trapping_region.h"

#include <gtest/gtest.h>

#include "base/message.h"
#include "checks.h"
#include "field/interpolation.h"
#include "flows.h"
#include "topology/fixed_points.h"
#include "tracing/streamline.h"

namespace stormfield::test {
namespace {

VectorField linear(const Eigen::Matrix2d& a, const Vec3& centre) {
  return sampledOn(grid(8), [&](const Vec3& p) {
    const Eigen::Vector2d v = a * (p - centre).head<2>();
    return Vec3(v.x(), v.y(), 0.0);
  });
}

Eigen::Matrix2d matrix(double a, double b, double c, double d) {
  return (Eigen::Matrix2d() << a, b, c, d).finished();
}

const Vec3 kInside(0.11, 0.03, 0.0);

TEST(TrappingRegion, OfALinearSinkIsItsLyapunovEllipse) {
  for (const Eigen::Matrix2d& a : {matrix(-1, 0, 0, -4), matrix(-1, 6, 0, -2), matrix(-0.2, -1, 1, -0.2)}) {
    for (const double sign : {1.0, -1.0}) {
      const VectorField field = linear(sign * a, kInside);
      const FixedPoint p = findFixedPoints(field).at(0);
      const TrappingRegion region = trappingRegion(field, p);
      EXPECT_EQ(region.forward, sign > 0.0);
      EXPECT_EQ(region.backward, sign < 0.0);
      ASSERT_EQ(region.ellipses.size(), 1u);
      const TrappingEllipse& ellipse = region.ellipses[0];
      EXPECT_EQ(ellipse.face, p.point.face);
      // J'M + MJ is a negative multiple of the identity.
      const Eigen::Matrix2d j = sign * p.jacobian, m = ellipse.metric;
      const Eigen::Matrix2d lyapunov = j.transpose() * m + m * j;
      EXPECT_LT(lyapunov(0, 0), 0.0);
      EXPECT_NEAR(lyapunov(0, 1), 0.0, 1e-9 * std::abs(lyapunov(0, 0)));
      EXPECT_NEAR(lyapunov(1, 1), lyapunov(0, 0), 1e-9 * std::abs(lyapunov(0, 0)));
      // It is the largest one in the face: the farthest level of a side is 1 / 0.998.
      const FaceInterpolant local = faceInterpolant(field, ellipse.face);
      double nearest = 1e300;
      for (int i = 0; i < 3; ++i) {
        const Complex side = local.corners[(i + 1) % 3] - local.corners[i];
        const Complex normal = Complex(0.0, 1.0) * side / std::abs(side);
        const double distance = ((ellipse.centre - local.corners[i]) * std::conj(normal)).real();
        const Eigen::Vector2d n(normal.real(), normal.imag());
        nearest = std::min(nearest, distance * distance / n.dot(m.inverse() * n));
      }
      EXPECT_NEAR(nearest, 1.0 / 0.998, 1e-9);
      // Its seed lies on it.
      const Complex seed = local.point(region.seed.barycentric) - ellipse.centre;
      const Eigen::Vector2d d(seed.real(), seed.imag());
      EXPECT_NEAR(d.dot(m * d), 1.0, 1e-9);
    }
  }
}

TEST(TrappingRegion, KeepsWhatEntersIt) {
  // A strongly bumped surface: the ellipse is shrunk until the curved field crosses it inwards.
  int checked = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const VectorField field = smoothField(bumpySphere(3, 0.15, seed + 1), seed);
    const FlatFaces faces(field.charts);
    for (const FixedPoint& p : findFixedPoints(field)) {
      const TrappingRegion region = trappingRegion(field, p);
      if (region.ellipses.size() != 1 || p.kind == FixedPointKind::Center) continue;
      const TrappingEllipse& ellipse = region.ellipses[0];
      const Direction direction = region.forward ? Direction::Forward : Direction::Backward;
      const Eigen::LLT<Eigen::Matrix2d> factor(ellipse.metric);
      std::vector<SurfacePoint> seeds;
      for (int i = 0; i < 7; ++i) {
        const Eigen::Vector2d d = factor.matrixU().solve(Eigen::Vector2d(std::cos(0.9 * i), std::sin(0.9 * i)));
        seeds.push_back({ellipse.face, faces[ellipse.face].barycentric(ellipse.centre + 0.999 * Complex(d[0], d[1]))});
      }
      const Traces traces = traceStreamlines(
          faces, field, seeds, {.direction = direction, .maxLength = field.mesh().size(), .tolerance = 1e-9});
      for (const SurfacePoint& q : traces.points) {
        ASSERT_EQ(q.face, ellipse.face) << "seed " << seed;
        EXPECT_TRUE(ellipse.contains(faces[q.face].point(q.barycentric))) << "seed " << seed;
      }
      ++checked;
    }
  }
  EXPECT_GE(checked, 10);
}

TEST(TrappingRegion, OfACenterIsTheLargestOrbitInItsFace) {
  const VectorField field = linear(matrix(0, -2, 0.5, 0), kInside);
  const FixedPoint p = findFixedPoints(field).at(0);
  ASSERT_EQ(p.kind, FixedPointKind::Center);
  const TrappingRegion region = trappingRegion(field, p);
  EXPECT_FALSE(region.forward || region.backward);
  ASSERT_EQ(region.ellipses.size(), 1u);
  // The form is constant along the flow: J'M + MJ = 0.
  const Eigen::Matrix2d m = region.ellipses[0].metric, derivative = p.jacobian.transpose() * m + m * p.jacobian;
  EXPECT_LT(derivative.norm(), 1e-12 * m.norm() * p.jacobian.norm());
  EXPECT_GT(m.determinant(), 0.0);
  EXPECT_GT(m.trace(), 0.0);
  // Its seed lies on a side, outside.
  EXPECT_NEAR(region.seed.barycentric.minCoeff(), 0.0, 1e-12);
  EXPECT_FALSE(region.ellipses[0].contains(faceInterpolant(field, p.point.face).point(region.seed.barycentric)));
}

TEST(TrappingRegion, OnEdgesAndAtVerticesIsADiskInEachFace) {
  const auto faceCount = [](const Vec3& centre) {
    const VectorField field = linear(matrix(-1, 0, 0, -1), centre);
    const TrappingRegion region = trappingRegion(field, findFixedPoints(field).at(0));
    EXPECT_TRUE(region.forward);
    EXPECT_FALSE(region.backward);
    for (const TrappingEllipse& disk : region.ellipses) {
      // A thousandth of the square root of the doubled area of a face: the cells have sides of 0.25.
      EXPECT_NEAR(1.0 / std::sqrt(disk.metric(0, 0)), 1e-3 * 0.25, 1e-12);
      EXPECT_EQ(disk.metric(0, 1), 0.0);
      EXPECT_EQ(disk.metric(1, 1), disk.metric(0, 0));
    }
    return region.ellipses.size();
  };
  EXPECT_EQ(faceCount({0.25, 0.1, 0.0}), 2u);
  EXPECT_EQ(faceCount({0.1, 0.1, 0.0}), 2u);
  EXPECT_EQ(faceCount({0.25, -0.5, 0.0}), 6u);
}

TEST(TrappingRegion, OfASaddleIsEmpty) {
  const VectorField field = linear(matrix(1, 0, 0, -1), kInside);
  const TrappingRegion region = trappingRegion(field, findFixedPoints(field).at(0));
  EXPECT_TRUE(region.ellipses.empty());
  EXPECT_FALSE(region.forward || region.backward);
}

}  // namespace
}  // namespace stormfield::test
