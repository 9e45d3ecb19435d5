#include "design/log_map.h"

#include <gtest/gtest.h>

#include "design/log_map_cache.h"
#include "fixtures.h"

namespace stormfield {
namespace {

SurfacePoint inFace(Index f) {
  return {f, {0.2, 0.5, 0.3}};
}

// Past obtuse corners the way runs along an edge, which costs up to a percent.
TEST(LogMap, IsPolarCoordinatesInThePlane) {
  const auto charts = test::makeCharts(test::grid(20, 0.3));
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
    const auto charts = test::makeCharts(test::dividedIcosahedron(n));
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
  const auto one = test::makeCharts(test::grid(10));
  const TriangleMesh& m = one->mesh();
  Points points(2 * m.vertexCount(), 3);
  Triangles triangles(2 * m.faceCount(), 3);
  points.topRows(m.vertexCount()) = m.points();
  points.bottomRows(m.vertexCount()) = m.points().rowwise() + Eigen::RowVector3d(0.0, 0.0, 0.01);
  triangles.topRows(m.faceCount()) = m.triangles();
  triangles.bottomRows(m.faceCount()) = m.triangles().array() + m.vertexCount();
  const auto charts = test::makeCharts({points, triangles});
  LogMapScratch scratch(charts->mesh());
  const LogMap map = logMap(*charts, inFace(99), 1.0, scratch);
  EXPECT_GT(map.entries.size(), 40u);
  for (const LogMapEntry& entry : map.entries) EXPECT_LT(entry.vertex, m.vertexCount());
  EXPECT_EQ(map.distance(charts->mesh(), inFace(99 + m.faceCount())), std::numeric_limits<double>::infinity());
}

TEST(LogMap, WorksAtVerticesEdgesAndCubeCorners) {
  const auto charts = test::makeCharts(test::cube());
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

TEST(LogMap, IsPartOfAnyLargerOne) {
  const auto charts = test::makeCharts(test::torus(40, 20, 1.0, 0.4, 0.2));
  const TriangleMesh& mesh = charts->mesh();
  LogMapScratch scratch(mesh);
  for (const Index f : {0, 77, 900}) {
    const LogMap large = logMap(*charts, inFace(f), 1.0, scratch);
    for (const double radius : {1e-6, 0.05, 0.3, 0.77, 1.0}) {
      ASSERT_TRUE(large.reaches(inFace(f), radius));
      const LogMap small = logMap(*charts, inFace(f), radius, scratch), part = large.within(mesh, radius);
      EXPECT_EQ(part.radius, radius);
      ASSERT_EQ(part.entries.size(), small.entries.size());
      for (std::size_t k = 0; k < small.entries.size(); ++k) {
        EXPECT_EQ(part.entries[k].vertex, small.entries[k].vertex);
        EXPECT_EQ(part.entries[k].distance, small.entries[k].distance);
        EXPECT_EQ(part.entries[k].angle, small.entries[k].angle);
        EXPECT_EQ(part.entries[k].arrival, small.entries[k].arrival);
      }
    }
    EXPECT_FALSE(large.reaches(inFace(f), 1.01));
    EXPECT_FALSE(large.reaches(inFace(f + 1), 0.1));
  }
}

TEST(LogMapCache, KeepsWhatTheLastDesignUsedAsFarAsItFits) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(8));
  LogMapScratch scratch(charts->mesh());
  LogMapCache kept;
  kept.start(1);
  scratch.useKept(&kept[0]);
  const auto map = [&](Index f, double radius) { return recentLogMap(*charts, inFace(f), radius, scratch).get(); };
  const LogMap *a = map(3, 0.5), *b = map(70, 0.5);
  kept[0].keepUsed(1000);
  kept.start(1);
  EXPECT_EQ(map(3, 0.5), a);
  kept[0].keepUsed(1000);
  kept.start(1);
  EXPECT_EQ(kept[0].find(charts->mesh(), inFace(70), 0.5), nullptr) << "not used by the last design";
  EXPECT_EQ(map(70, 0.5), b) << "from the recent ones";
  EXPECT_EQ(map(3, 0.5), a);
  kept[0].keepUsed(b->entries.size());
  kept.start(1);
  EXPECT_EQ(kept[0].find(charts->mesh(), inFace(3), 0.5), nullptr) << "did not fit";
  EXPECT_NE(kept[0].find(charts->mesh(), inFace(70), 0.5), nullptr);
}

}  // namespace
}  // namespace stormfield
