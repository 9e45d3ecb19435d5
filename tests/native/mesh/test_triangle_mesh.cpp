#include "mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

void expectRefused(const Surface& s, const std::vector<std::string>& parts) {
  expectFault<MeshError>([&] { TriangleMesh(s.points, s.triangles); }, parts);
}

Surface withFace(Surface s, Index a, Index b, Index c) {
  s.triangles.conservativeResize(s.triangles.rows() + 1, 3);
  s.triangles.row(s.triangles.rows() - 1) << a, b, c;
  return s;
}

Surface withVertex(Surface s, const Vec3& p) {
  s.points.conservativeResize(s.points.rows() + 1, 3);
  s.points.row(s.points.rows() - 1) = p;
  return s;
}

TEST(TriangleMesh, KnowsItsTopology) {
  for (const NamedSurface& s : closedSurfaces()) {
    const auto mesh = makeMesh(s.surface);
    EXPECT_EQ(mesh->eulerCharacteristic(), s.euler) << s.name;
    EXPECT_EQ(mesh->boundaryLoopCount(), 0) << s.name;
    EXPECT_EQ(mesh->flippedFaceCount(), 0) << s.name;
  }
  for (const NamedSurface& s : boundedSurfaces())
    EXPECT_EQ(makeMesh(s.surface)->eulerCharacteristic(), s.euler) << s.name;
  EXPECT_EQ(makeMesh(grid(3))->boundaryLoopCount(), 1);
  EXPECT_EQ(makeMesh(cylinder(7, 2))->boundaryLoopCount(), 2);
  const auto several = makeMesh(severalComponents());
  EXPECT_EQ(several->componentCount(), 3);
  EXPECT_EQ(several->component(0), 0);
  EXPECT_EQ(several->component(several->vertexCount() - 1), 2);
}

TEST(TriangleMesh, HalfedgesAgree) {
  for (const Surface& s : {severalComponents(), plateWithHoles(2), annulus(9, 2), tetrahedron()}) {
    const auto mesh = makeMesh(s);
    std::vector<Index> visits(mesh->halfedgeCount(), 0);
    for (Index v = 0; v < mesh->vertexCount(); ++v) {
      EXPECT_EQ(mesh->isBoundaryVertex(v), mesh->twin(mesh->outgoing(v)) == kNone);
      for (Index h = mesh->outgoing(v); h != kNone; h = mesh->nextOutgoing(h)) {
        EXPECT_EQ(mesh->tail(h), v);
        ++visits[h];
      }
    }
    for (Index h = 0; h < mesh->halfedgeCount(); ++h) {
      EXPECT_EQ(visits[h], 1) << "the fan of a vertex visits each of its faces once";
      EXPECT_EQ(mesh->head(h), mesh->tail(TriangleMesh::next(h)));
      EXPECT_EQ(TriangleMesh::prev(TriangleMesh::next(h)), h);
      const Index t = mesh->twin(h);
      if (t == kNone) {
        EXPECT_EQ(mesh->edgeHalfedge(mesh->edge(h)), h);
        EXPECT_TRUE(mesh->isBoundaryVertex(mesh->tail(h)) && mesh->isBoundaryVertex(mesh->head(h)));
        continue;
      }
      EXPECT_EQ(mesh->twin(t), h);
      EXPECT_EQ(mesh->edge(t), mesh->edge(h));
      EXPECT_EQ(mesh->tail(t), mesh->head(h));
      EXPECT_EQ(mesh->edgeHalfedge(mesh->edge(h)), std::min(h, t));
    }
  }
}

TEST(TriangleMesh, MeasuresFaces) {
  const auto square = makeMesh(grid(5, 0.3));
  EXPECT_NEAR(square->totalArea(), 4.0, 1e-13);
  EXPECT_NEAR(square->size(), 2.0, 1e-13);
  for (Index v = 0; v < square->vertexCount(); ++v) {
    double angle = 0.0;
    for (Index h = square->outgoing(v); h != kNone; h = square->nextOutgoing(h)) angle += square->cornerAngle(h);
    if (!square->isBoundaryVertex(v)) {
      EXPECT_NEAR(angle, 2.0 * kPi, 1e-13);
    }
  }
  const auto sphere = makeMesh(icosphere(4));
  EXPECT_NEAR(sphere->totalArea(), 4.0 * kPi, 0.02);
  for (Index f = 0; f < sphere->faceCount(); ++f) {
    EXPECT_NEAR(sphere->cornerAngle(3 * f) + sphere->cornerAngle(3 * f + 1) + sphere->cornerAngle(3 * f + 2), kPi,
                1e-14);
    EXPECT_GT(sphere->faceNormal(f).dot(sphere->point(sphere->vertex(f, 0))), 0.9);
  }
}

TEST(TriangleMesh, FlipsTheMinority) {
  Surface s = icosphere(1);
  for (const Index f : {3, 17, 40}) std::swap(s.triangles(f, 0), s.triangles(f, 1));
  const auto mesh = makeMesh(s);
  EXPECT_EQ(mesh->flippedFaceCount(), 3);
  EXPECT_EQ(mesh->eulerCharacteristic(), 2);
  for (Index f = 0; f < mesh->faceCount(); ++f)
    EXPECT_GT(mesh->faceNormal(f).dot(mesh->point(mesh->vertex(f, 0))), 0.0);

  // Each component has its own majority.
  Surface two = joined(s, icosphere(0), {4, 0, 0});
  for (Index f = 80; f < 100; ++f) std::swap(two.triangles(f, 1), two.triangles(f, 2));
  EXPECT_EQ(makeMesh(two)->flippedFaceCount(), 3);
}

TEST(TriangleMesh, KeepsVerticesThatNoFaceUses) {
  const auto mesh = makeMesh(withVertex(icosphere(0), {5, 5, 5}));
  EXPECT_EQ(mesh->vertexCount(), 13);
  EXPECT_EQ(mesh->eulerCharacteristic(), 2);
  EXPECT_EQ(mesh->component(12), kNone);
  EXPECT_EQ(mesh->outgoing(12), kNone);
  EXPECT_EQ(mesh->vertexArea(12), 0.0);
}

TEST(TriangleMesh, RefusesNothingToWorkOn) {
  expectRefused({grid(2).points, Triangles(0, 3)}, {"no faces"});
  expectRefused({Points(0, 3), Triangles(0, 3)}, {"no faces"});
}

TEST(TriangleMesh, RefusesBadIndices) {
  expectRefused(withFace(tetrahedron(), 0, 1, 4), {"face 4", "vertex 4", "0 to 3"});
  expectRefused(withFace(tetrahedron(), 0, -1, 2), {"face 4", "vertex -1"});
  expectRefused(withFace(tetrahedron(), 2, 1, 2), {"face 4", "vertex 2 twice", "delete"});
}

TEST(TriangleMesh, RefusesCoordinatesThatAreNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Surface s = icosphere(0);
    s.points(7, 1) = bad;
    expectRefused(s, {"vertex 7", "not finite"});
  }
}

TEST(TriangleMesh, RefusesFacesWithoutArea) {
  Surface s = grid(2);
  s.points.row(4) = s.points.row(1);
  expectRefused(s, {"face ", "no area", "dissolve"});
  expectRefused(surface({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}, {{0, 1, 2}}), {"face 0 (vertices 0, 1, 2)", "no area"});
}

TEST(TriangleMesh, AcceptsAnyScale) {
  for (const double scale : {1e-30, 1e-9, 1e9, 1e30}) {
    Surface s = icosphere(1);
    s.points *= scale;
    EXPECT_NEAR(makeMesh(s)->totalArea() / (scale * scale), makeMesh(icosphere(1))->totalArea(), 1e-12);
  }
}

TEST(TriangleMesh, RefusesRepeatedFaces) {
  expectRefused(withFace(tetrahedron(), 1, 2, 0), {"face 4", "same corners as face 0", "delete"});
  expectRefused(withFace(grid(2), 4, 1, 0), {"face 8", "face 0"});
}

TEST(TriangleMesh, RefusesEdgesWithThreeFaces) {
  const Surface s = withFace(withVertex(tetrahedron(), {3, 3, 3}), 0, 1, 4);
  expectRefused(s, {"edge (0, 1)", "3 faces", "separate"});
}

TEST(TriangleMesh, RefusesVerticesWithTwoFans) {
  expectRefused(surface({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}),
                {"vertex 0", "fans", "split"});
  // Two closed tetrahedra that touch in a point.
  Surface s = joined(tetrahedron(), tetrahedron(), {2, 2, 2});
  s.triangles = (s.triangles.array() == 7).select(0, s.triangles);
  expectRefused(s, {"vertex 0", "fans"});
}

TEST(TriangleMesh, RefusesOneSidedSurfaces) {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> faces;
  const int n = 9;
  for (int i = 0; i < n; ++i) {
    const double u = 2.0 * kPi * i / n;
    for (const double w : {-0.3, 0.3}) {
      points.emplace_back((1.0 + w * std::cos(u / 2)) * std::cos(u), (1.0 + w * std::cos(u / 2)) * std::sin(u),
                          w * std::sin(u / 2));
    }
    const Index a = 2 * i, b = 2 * i + 1, last = i + 1 == n;
    const Index c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    faces.push_back({a, c, b});
    faces.push_back({b, c, d});
  }
  expectRefused(surface(points, faces), {"one-sided", "faces ", "edge (", "cut"});
}

}  // namespace
}  // namespace stormfield::test
