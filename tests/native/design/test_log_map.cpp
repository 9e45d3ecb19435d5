#include "design/log_map.h"

#include <gtest/gtest.h>

#include "tracing/surfaces.h"

namespace stormfield {
namespace {

SurfacePoint inFace(Index f) {
  return {f, {0.2, 0.5, 0.3}};
}

// Past obtuse corners the way runs along an edge, which costs up to a percent.
TEST(LogMap, IsPolarCoordinatesInThePlane) {
  const auto charts = surfaces::square(20, 0.3);
  const TriangleMesh& mesh = charts->mesh();
  LogMapScratch scratch(mesh);
  for (const Index f : {0, 150, 411, 640}) {
    const SurfacePoint source = inFace(f);
    const Vec3 centre = position(mesh, source);
    const LogMap map = logMap(*charts, source, 0.5, scratch);
    std::size_t inside = 0;
    for (Index v = 0; v < mesh.vertexCount(); ++v) inside += (mesh.point(v) - centre).norm() < 0.5;
    EXPECT_GE(map.entries.size(), inside);
    for (const LogMapEntry& entry : map.entries) {
      const Vec3 away = mesh.point(entry.vertex) - centre;
      EXPECT_NEAR(entry.distance, away.norm(), 0.01 * away.norm() + 1e-4);
      const Vec3 leaving = charts->faceToSpace(f, std::polar(1.0, entry.angle));
      EXPECT_LT((leaving - away.normalized()).norm(), 0.06);
      EXPECT_LT((charts->toSpace(entry.vertex, entry.arrival) - away.normalized()).norm(), 0.06);
    }
  }
}

TEST(LogMap, FollowsGreatCircles) {
  double before = 1.0;
  for (const Index n : {8, 16, 32}) {
    const auto charts = surfaces::sphere(n);
    const TriangleMesh& mesh = charts->mesh();
    LogMapScratch scratch(mesh);
    const SurfacePoint source = inFace(7);
    const Vec3 centre = position(mesh, source).normalized();
    const LogMap map = logMap(*charts, source, 1.5, scratch);
    double worstDistance = 0.0, worstArrival = 0.0, worstAngle = 0.0;
    for (const LogMapEntry& entry : map.entries) {
      const Vec3 p = mesh.point(entry.vertex).normalized();
      const Vec3 leaving = (p - p.dot(centre) * centre).normalized();
      const Vec3 arriving = (p.dot(centre) * p - centre).normalized();
      worstDistance = std::max(worstDistance, std::abs(entry.distance - std::acos(p.dot(centre))));
      if (entry.distance < 2.0 / n) continue;
      worstArrival = std::max(worstArrival, (charts->toSpace(entry.vertex, entry.arrival) - arriving).norm());
      worstAngle =
          std::max(worstAngle, (charts->faceToSpace(source.face, std::polar(1.0, entry.angle)) - leaving).norm());
    }
    std::printf("n %d: distance %.2g, arrival %.2g, angle %.2g\n", n, worstDistance, worstArrival, worstAngle);
    EXPECT_LT(worstDistance, 0.6 * before);
    EXPECT_LT(worstArrival, 0.2);
    EXPECT_LT(worstAngle, 0.2);
    before = worstDistance;
  }
}

/// Two squares that almost touch, in two components.
TEST(LogMap, StaysOnItsOwnSheet) {
  const auto one = surfaces::square(10);
  const TriangleMesh& m = one->mesh();
  Points points(2 * m.vertexCount(), 3);
  Triangles triangles(2 * m.faceCount(), 3);
  points.topRows(m.vertexCount()) = m.points();
  points.bottomRows(m.vertexCount()) = m.points().rowwise() + Eigen::RowVector3d(0.0, 0.0, 0.01);
  triangles.topRows(m.faceCount()) = m.triangles();
  triangles.bottomRows(m.faceCount()) = m.triangles().array() + m.vertexCount();
  const auto charts = surfaces::charts(points, triangles);
  LogMapScratch scratch(charts->mesh());
  const LogMap map = logMap(*charts, inFace(99), 1.0, scratch);
  EXPECT_GT(map.entries.size(), 40u);
  for (const LogMapEntry& entry : map.entries) EXPECT_LT(entry.vertex, m.vertexCount());
  EXPECT_EQ(map.distance(charts->mesh(), inFace(99 + m.faceCount())), std::numeric_limits<double>::infinity());
}

TEST(LogMap, WorksAtVerticesEdgesAndCubeCorners) {
  const auto charts = surfaces::cube();
  const TriangleMesh& mesh = charts->mesh();
  LogMapScratch scratch(mesh);
  for (const Eigen::Vector3d& b : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.5, 0.5, 0), Eigen::Vector3d(0, 0, 1)}) {
    const LogMap map = logMap(*charts, {3, b}, 10.0, scratch);
    ASSERT_EQ(map.entries.size(), 8u);
    for (const LogMapEntry& entry : map.entries) {
      EXPECT_NEAR(std::abs(entry.arrival), 1.0, 1e-9);
      EXPECT_LT(entry.distance, 3.0);
    }
  }
}

}  // namespace
}  // namespace stormfield
