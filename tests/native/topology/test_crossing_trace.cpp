#include "topology/detail/crossing_trace.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/message.h"
#include "checks.h"
#include "flows.h"

namespace stormfield::test {
namespace {

Vec3 placeOf(const TriangleMesh& mesh, const EdgePassage& passage) {
  if (passage.vertex != kNone) return mesh.point(passage.vertex);
  const Vec3 tail = mesh.point(mesh.tail(passage.halfedge)), head = mesh.point(mesh.head(passage.halfedge));
  return (1.0 - passage.fraction) * tail + passage.fraction * head;
}

TEST(CrossingTrace, ReportsEveryEdgeAndVertexThatAStraightPathCrosses) {
  // In cells of 1 with diagonals along (1, 1), from a tenth of the way to the next vertex: over a vertex each time
  // the direction is gone, and over so many edges in between.
  constexpr int kCells = 12;
  struct Path {
    Vec3 direction, from;
    int vertices, edgesBetween;
  };
  const std::vector<Path> paths = {{{2, 1, 0}, {1, 1, 0}, 5, 1},     {{1, 2, 0}, {1, 1, 0}, 5, 1},
                                   {{-1, 1, 0}, {11, 1, 0}, 10, 1},  {{1, -1, 0}, {1, 11, 0}, 10, 1},
                                   {{-2, -1, 0}, {11, 11, 0}, 5, 1}, {{3, 2, 0}, {1, 1, 0}, 3, 3},
                                   {{-3, 1, 0}, {11, 1, 0}, 3, 5}};
  const auto inSpace = [](const Vec3& cells) { return Vec3(2.0 / kCells * cells - Vec3(1, 1, 0)); };
  for (const Path& path : paths) {
    for (const Direction direction : {Direction::Forward, Direction::Backward}) {
      const double sign = direction == Direction::Forward ? 1.0 : -1.0;
      const VectorField field = sampledOn(grid(kCells), [&](const Vec3&) { return Vec3(sign * path.direction); });
      const TriangleMesh& mesh = field.mesh();
      const FlatFaces faces(field.charts);
      const std::string what = message("direction ", path.direction.x(), ", ", path.direction.y(), ", sign ", sign);
      SurfacePoint seed;
      const Vec3 start = inSpace(path.from + 0.1 * path.direction);
      for (Index f = 0; f < mesh.faceCount(); ++f) {
        const Eigen::Vector3d b =
            faces[f].barycentric(field.charts->spaceToFace(f, start - mesh.point(mesh.vertex(f, 0))));
        if (b.minCoeff() > 1e-3) seed = {f, b};
      }
      CrossingTrace trace(faces, field, direction, 1e-9);
      std::vector<Index> vertices;
      int edges = 0, passages = 0;
      const TraceEnd end = trace.run(seed, [&](const SurfacePoint& p, double, const EdgePassage& passage) {
        if (!passage) return true;
        ++passages;
        EXPECT_LT((placeOf(mesh, passage) - position(mesh, p)).norm(), 1e-4 / kCells) << what;
        if (passage.vertex != kNone) {
          EXPECT_EQ(edges, path.edgesBetween) << what << ", before vertex " << vertices.size();
          edges = 0;
          vertices.push_back(passage.vertex);
        } else {
          ++edges;
          // The flow, whatever the direction of the trace, enters the face of the halfedge.
          const Index face =
              TriangleMesh::face(direction == Direction::Forward ? passage.halfedge : mesh.twin(passage.halfedge));
          EXPECT_EQ(face, p.face) << what;
        }
        return true;
      });
      EXPECT_EQ(passages, end.crossings) << what;
      ASSERT_EQ(vertices.size(), static_cast<std::size_t>(path.vertices)) << what;
      for (int i = 0; i < path.vertices; ++i) {
        EXPECT_LT((mesh.point(vertices[i]) - inSpace(path.from + (i + 1) * path.direction)).norm(), 1e-12) << what;
      }
    }
  }
}

/// The point of a flat mesh at a place.
SurfacePoint pointAt(const FlatFaces& faces, const Vec3& place) {
  const TriangleMesh& mesh = faces.mesh();
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const Eigen::Vector3d b =
        faces[f].barycentric(faces.charts().spaceToFace(f, place - mesh.point(mesh.vertex(f, 0))));
    if (b.minCoeff() > 1e-6) return {f, b};
  }
  return {};
}

TEST(CrossingTrace, ReportsEdgesInTheirOrder) {
  // The lines of the grid are x = i, y = i and x - y = i, in cells: a straight path crosses them where it does.
  constexpr int kCells = 10;
  const auto inCells = [](const Vec3& p) { return Vec3(0.5 * kCells * (p + Vec3(1, 1, 0))); };
  for (const Vec3& velocity : {Vec3(1.0, 0.37, 0.0), Vec3(-0.61, 0.83, 0.0), Vec3(0.2, -0.9, 0.0)}) {
    for (const Direction direction : {Direction::Forward, Direction::Backward}) {
      const double sign = direction == Direction::Forward ? 1.0 : -1.0;
      const VectorField field = sampledOn(grid(kCells), [&](const Vec3&) { return velocity; });
      const FlatFaces faces(field.charts);
      const TriangleMesh& mesh = field.mesh();
      const Vec3 start(0.013, -0.027, 0.0), from = inCells(start), rate = 0.5 * kCells * sign * velocity;
      std::vector<double> expected;  // seconds
      for (int i = -kCells; i <= kCells; ++i) {
        for (const double time : {(i - from.x()) / rate.x(), (i - from.y()) / rate.y(),
                                  (i - (from.x() - from.y())) / (rate.x() - rate.y())}) {
          const Vec3 there = from + time * rate;
          const bool inside = there.head<2>().minCoeff() > 1e-9 && there.head<2>().maxCoeff() < kCells - 1e-9;
          if (time > 0.0 && inside) expected.push_back(time);
        }
      }
      std::sort(expected.begin(), expected.end());

      std::vector<double> times;
      CrossingTrace trace(faces, field, direction, 1e-9);
      trace.run(pointAt(faces, start), [&](const SurfacePoint&, double time, const EdgePassage& passage) {
        if (!passage || mesh.twin(passage.halfedge) == kNone) return true;
        times.push_back(time);
        expectNear(placeOf(mesh, passage), start + sign * time * velocity, 1e-9);
        return true;
      });
      ASSERT_EQ(times.size(), expected.size());
      for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], expected[i], 1e-9) << i;
    }
  }
}

TEST(CrossingTrace, EndsWhenItsVisitorSaysSo) {
  const VectorField field = sampledOn(grid(10), [](const Vec3&) { return Vec3(1.0, 0.37, 0.0); });
  const FlatFaces faces(field.charts);
  CrossingTrace trace(faces, field, Direction::Forward, 1e-9);
  int visits = 0;
  const TraceEnd end = trace.run(pointAt(faces, Vec3(0.013, -0.027, 0.0)),
                                 [&](const SurfacePoint&, double, const EdgePassage&) { return ++visits < 3; });
  EXPECT_EQ(visits, 3);
  EXPECT_EQ(end.reason, StopReason::Visitor);
}

}  // namespace
}  // namespace stormfield::test
