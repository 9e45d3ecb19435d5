#include "mesh/closest_point.h"

#include <gtest/gtest.h>

#include <limits>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

Vec3 corner(const TriangleMesh& mesh, Index f, int k) {
  return mesh.point(mesh.vertex(f, k));
}

/// No point of a triangle is closer to p than q if the triangle lies behind the plane through q that faces p.
bool certified(const TriangleMesh& mesh, Index f, const Vec3& p, const Vec3& q) {
  double ahead = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) ahead = std::max(ahead, (corner(mesh, f, k) - q).dot(p - q));
  return ahead <= 1e-12;
}

/// Lower bound of the distance to a triangle by cutting it into ever smaller ones.
double bruteForce(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, double best, int depth) {
  const Vec3 centre = (a + b + c) / 3.0;
  const double reach = std::max({(a - centre).norm(), (b - centre).norm(), (c - centre).norm()});
  const double here = (p - centre).norm();
  if (here - reach >= best) return best;
  best = std::min({best, here, (p - a).norm(), (p - b).norm(), (p - c).norm()});
  if (depth == 0) return best;
  const Vec3 x = (a + b) / 2, y = (b + c) / 2, z = (c + a) / 2;
  best = bruteForce(p, x, y, z, best, depth - 1);
  best = bruteForce(p, a, x, z, best, depth - 1);
  best = bruteForce(p, x, b, y, best, depth - 1);
  return bruteForce(p, z, y, c, best, depth - 1);
}

TEST(ClosestPoint, AgreesWithBruteForce) {
  Random random(11);
  for (const Surface& s : {bumpySphere(1, 0.4), severalComponents(), grid(4, 0.3)}) {
    const auto mesh = makeMesh(s);
    const ClosestPointQuery query(mesh);
    for (int i = 0; i < 60; ++i) {
      const Vec3 p = 2.0 * random.vector();
      const ClosestPoint found = query.closest(p);
      for (const Index face : {found.point.face, Index{0}}) {
        const ClosestPoint nearby = query.closest(p, SurfacePoint{face, Vec3::Constant(1.0 / 3.0)});
        EXPECT_EQ(nearby.point.face, found.point.face);
        EXPECT_EQ(nearby.point.barycentric, found.point.barycentric);
        EXPECT_EQ(nearby.distance, found.distance);
      }
      const Vec3 q = position(*mesh, found.point);
      EXPECT_NEAR((p - q).norm(), found.distance, 1e-13);
      EXPECT_GE(found.point.barycentric.minCoeff(), 0.0);
      EXPECT_NEAR(found.point.barycentric.sum(), 1.0, 1e-15);
      EXPECT_TRUE(certified(*mesh, found.point.face, p, q));
      double best = std::numeric_limits<double>::infinity();
      for (Index f = 0; f < mesh->faceCount(); ++f) {
        best = bruteForce(p, corner(*mesh, f, 0), corner(*mesh, f, 1), corner(*mesh, f, 2), best, 12);
      }
      EXPECT_LE(found.distance, best + 1e-12);
      EXPECT_GE(found.distance, best - 1e-3);
    }
  }
}

TEST(ClosestPoint, PointsOnTheSurfaceAreTheirOwn) {
  const auto mesh = makeMesh(bumpySphere(2));
  const ClosestPointQuery query(mesh);
  Random random(5);
  Points points(200, 3);
  for (int i = 0; i < 200; ++i)
    points.row(i) = position(*mesh, {random.below(mesh->faceCount()), random.barycentric()});
  const std::vector<ClosestPoint> found = query.closest(points);
  for (int i = 0; i < 200; ++i) {
    EXPECT_LE(found[i].distance, 1e-14);
    const ClosestPoint single = query.closest(Vec3(points.row(i)));
    EXPECT_EQ(single.point.face, found[i].point.face);
    EXPECT_EQ(single.point.barycentric, found[i].point.barycentric);
  }
}

TEST(ClosestPoint, WorksOnASingleTriangle) {
  const ClosestPointQuery query(makeMesh(surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})));
  const ClosestPoint found = query.closest(Vec3(0.25, 0.25, 2.0));
  EXPECT_EQ(found.distance, 2.0);
  expectNear(found.point.barycentric, Vec3(0.5, 0.25, 0.25), 1e-15);
  EXPECT_EQ(query.closest(Vec3(-3, -4, 0)).distance, 5.0);
}

TEST(ClosestPoint, RefusesPointsThatAreNotFinite) {
  const ClosestPointQuery query(makeMesh(tetrahedron()));
  Points points = Points::Zero(3, 3);
  points(2, 1) = std::numeric_limits<double>::quiet_NaN();
  expectFault<InputError>([&] { query.closest(points); }, {"query point 2", "not finite"});
  expectFault<InputError>([&] { query.closest(Vec3(points.row(2))); }, {"not finite"});
}

}  // namespace
}  // namespace stormfield::test
