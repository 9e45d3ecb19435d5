#include "edit/move.h"

#include <gtest/gtest.h>

#include "checks.h"
#include "edited_fields.h"
#include "mesh/closest_point.h"

namespace stormfield::test {
namespace {

Index nearestPoint(const Topology& topology, const Vec3& place) {
  Index nearest = 0;
  for (std::size_t i = 0; i < topology.fixedPoints.size(); ++i) {
    if ((topology.fixedPoints[i].position - place).norm() < (topology.fixedPoints[nearest].position - place).norm()) {
      nearest = static_cast<Index>(i);
    }
  }
  return nearest;
}

TEST(Move, ThereAndBackGivesTheSameGraph) {
  const VectorField field =
      sampledOn(grid(40, 0.2), [](const Vec3& p) { return Vec3(0.25 - p.x() * p.x(), -p.y(), 0.0); });
  const FlatFaces faces(field.charts);
  const ClosestPointQuery query(field.charts->meshPointer());
  const Topology before = findTopology(faces, field);
  ASSERT_EQ(before.fixedPoints.size(), 2u);
  for (const Vec3& from : {Vec3(0.5, 0, 0), Vec3(-0.5, 0, 0)}) {
    const Vec3 to = from + Vec3(0.08, 0.21, 0.0);
    const Index point = nearestPoint(before, from);
    const EditResult there = movePoint(faces, field, before, point, query.closest(to).point);
    ASSERT_TRUE(there.applied) << there.reason;
    const Index moved = nearestPoint(there.topology, to);
    EXPECT_EQ(there.topology.fixedPoints[moved].kind, before.fixedPoints[point].kind);
    EXPECT_LE((there.topology.fixedPoints[moved].position - to).norm(), kMoveTolerance * field.mesh().meanEdgeLength());
    for (std::size_t v = 0; v < field.values.size(); ++v) {
      if (std::binary_search(there.vertices.begin(), there.vertices.end(), static_cast<Index>(v))) continue;
      EXPECT_EQ(there.field.values[v], field.values[v]);
    }
    const EditResult back = movePoint(faces, there.field, there.topology, moved, query.closest(from).point);
    ASSERT_TRUE(back.applied) << back.reason;
    EXPECT_EQ(back.topology.fixedPoints.size(), before.fixedPoints.size());
    EXPECT_EQ(back.topology.links.size(), before.links.size());
  }
}

TEST(Move, RandomPointsOfCurvedSurfaces) {
  int moved = 0, tried = 0;
  for (const Surface& s : {icosphere(4), torus(48, 24)}) {
    const VectorField field = smoothField(s, 2);
    const FlatFaces faces(field.charts);
    const ClosestPointQuery query(field.charts->meshPointer());
    const Topology before = findTopology(faces, field);
    Random random(4);
    for (std::size_t i = 0; i < before.fixedPoints.size(); ++i) {
      const Vec3 to = before.fixedPoints[i].position + 2.0 * field.mesh().meanEdgeLength() * random.vector();
      const EditResult result = movePoint(faces, field, before, static_cast<Index>(i), query.closest(to).point);
      ++tried;
      moved += result.applied;
      if (!result.applied) {
        EXPECT_EQ(result.field.values, field.values);
        EXPECT_NE(result.reason.find("cannot be moved there"), std::string::npos) << result.reason;
      }
    }
  }
  EXPECT_GE(10 * moved, 8 * tried) << moved << " of " << tried;
}

TEST(Move, RefusesWhatCannotBe) {
  const Surface two = joined(icosphere(3), icosphere(3), {4, 0, 0});
  const VectorField field = smoothField(two, 1);
  const FlatFaces faces(field.charts);
  const ClosestPointQuery query(field.charts->meshPointer());
  const Topology topology = findTopology(faces, field);
  const Index first = nearestPoint(topology, {0, 0, 0});
  const auto reason = [&](Index point, const SurfacePoint& target) {
    const EditResult result = movePoint(faces, field, topology, point, target);
    EXPECT_FALSE(result.applied);
    EXPECT_EQ(result.field.values, field.values);
    return result.reason;
  };
  const SurfacePoint far = query.closest(Vec3(5, 0, 0)).point;
  EXPECT_NE(reason(999, far).find("no fixed point 999"), std::string::npos);
  EXPECT_NE(reason(first, far).find("another part of the surface"), std::string::npos);
  EXPECT_NE(reason(first, {kNone, {1, 0, 0}}).find("there is no face"), std::string::npos);
}

}  // namespace
}  // namespace stormfield::test
