#include "topology/detail/crossing_trace.h"

#include <gtest/gtest.h>

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

TEST(FlowWalk, TellsOfEveryEdgeAndVertexThatAStraightPathGoesOver) {
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
      FlowWalk walk(faces, field, direction, 1e-9);
      std::vector<Index> vertices;
      int edges = 0, passages = 0;
      const TraceEnd end = walk.run(seed, [&](const SurfacePoint& p, double, const EdgePassage& passage) {
        if (!passage) return true;
        ++passages;
        EXPECT_LT((placeOf(mesh, passage) - position(mesh, p)).norm(), 1e-4 / kCells) << what;
        if (passage.vertex != kNone) {
          EXPECT_EQ(edges, path.edgesBetween) << what << ", before vertex " << vertices.size();
          edges = 0;
          vertices.push_back(passage.vertex);
        } else {
          ++edges;
          // The flow, whichever way the walk goes, enters the face of the halfedge.
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

}  // namespace
}  // namespace stormfield::test
