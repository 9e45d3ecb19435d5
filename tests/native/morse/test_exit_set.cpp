#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "fixtures.h"
#include "maps/geometry_map.h"
#include "morse/detail/exit_set.h"

namespace stormfield::test {
namespace {

using Flow = std::function<Vec3(const Vec3&)>;

VectorField fieldOf(const Surface& s, const Flow& flow) {
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = flow(s.points.row(v));
  return fromSpace(makeCharts(s), vectors);
}

Vec3 centroid(const TriangleMesh& mesh, Index f) {
  return (mesh.point(mesh.vertex(f, 0)) + mesh.point(mesh.vertex(f, 1)) + mesh.point(mesh.vertex(f, 2))) / 3.0;
}

/// The faces whose centroids are inside.
FaceSets facesWhere(const TriangleMesh& mesh, const std::function<bool(const Vec3&)>& isInside) {
  std::vector<Index> setOf(mesh.faceCount(), kNone);
  for (Index f = 0; f < mesh.faceCount(); ++f) setOf[f] = isInside(centroid(mesh, f)) ? 0 : kNone;
  return {std::move(setOf), 1};
}

FaceSets allFaces(const TriangleMesh& mesh) {
  return facesWhere(mesh, [](const Vec3&) { return true; });
}

bool inSquare(const Vec3& p) {
  return std::abs(p.x()) < 0.5 && std::abs(p.y()) < 0.5;
}

/// The exits of the set are just those boundary edges over which the flow points out of it at the middle.
void expectExitsWhereFlowLeaves(const VectorField& field, const FaceSets& sets, const IndexPair& pair,
                                const Flow& flow) {
  const TriangleMesh& mesh = field.mesh();
  int boundaryEdges = 0;
  ASSERT_EQ(pair.exits.size(), 3 * sets.members(0).size());
  for (std::size_t i = 0; i < sets.members(0).size(); ++i) {
    for (Index k = 0; k < 3; ++k) {
      const Index h = 3 * sets.members(0)[i] + k, twin = mesh.twin(h);
      if (twin != kNone && sets.setOf(TriangleMesh::face(twin)) == 0) continue;
      ++boundaryEdges;
      const Vec3 along = mesh.point(mesh.head(h)) - mesh.point(mesh.tail(h));
      const Vec3 outward = along.cross(Vec3::UnitZ());
      const Vec3 middle = 0.5 * (mesh.point(mesh.tail(h)) + mesh.point(mesh.head(h)));
      const Exit wanted = flow(middle).dot(outward) > 0.0 ? Exit::Whole : Exit::None;
      EXPECT_EQ(pair.exits[3 * i + static_cast<std::size_t>(k)], wanted) << "at " << middle.transpose();
    }
  }
  EXPECT_GT(boundaryEdges, 4);
}

/// Index of the set by the exits of a geometry-based map, and by those of the map as if it were any.
void expectIndex(const Surface& s, const std::function<bool(const Vec3&)>& isInside, const Flow& flow,
                 const ConleyIndex& wanted) {
  const VectorField field = fieldOf(s, flow);
  const FaceSets sets = facesWhere(field.mesh(), isInside);
  const CombinatorialMap map = geometryMap(field);
  const IndexPair pair = flowPair(field, map, sets, 0);
  expectExitsWhereFlowLeaves(field, sets, pair, flow);
  EXPECT_EQ(conleyIndex(field.mesh(), sets, 0, pair), wanted);
  EXPECT_EQ(conleyIndex(field.mesh(), sets, 0, mapPair(field, map, sets, 0)), wanted);
  EXPECT_EQ(internalTangencies(field, sets, 0), 0);
}

// Inside the surface --------------------------------------------------------------------------------------------------

TEST(ExitSet, OfASinkIsEmpty) {
  expectIndex(grid(8), inSquare, [](const Vec3& p) { return Vec3(0.03 - p.x(), 0.05 - p.y(), 0.0); }, {1, 0, 0});
}

TEST(ExitSet, OfASourceIsTheWholeBoundary) {
  expectIndex(grid(8), inSquare, [](const Vec3& p) { return Vec3(p.x() - 0.03, p.y() - 0.05, 0.0); }, {0, 0, 1});
}

TEST(ExitSet, OfASaddleIsTwoSides) {
  expectIndex(grid(8), inSquare, [](const Vec3& p) { return Vec3(p.x() - 0.03, 0.05 - p.y(), 0.0); }, {0, 1, 0});
}

TEST(ExitSet, OfFlowThatPassesIsOneSide) {
  expectIndex(grid(8), inSquare, [](const Vec3& p) { return Vec3(1.0, 0.05 - p.y(), 0.0); }, {0, 0, 0});
}

TEST(ExitSet, OfOrbitsInAnAnnulus) {
  const auto inRing = [](const Vec3& p) { return p.norm() > 1.2 && p.norm() < 1.8; };
  for (const double sign : {1.0, -1.0}) {
    const auto flow = [&](const Vec3& p) {
      return Vec3(sign * (1.5 - p.norm()) * p / p.norm() + 0.2 * Vec3(-p.y(), p.x(), 0.0));
    };
    expectIndex(annulus(40, 10), inRing, flow, sign > 0.0 ? ConleyIndex{1, 1, 0} : ConleyIndex{0, 1, 1});
  }
}

TEST(ExitSet, OfMapsHasTheVerticesOfAllFacesThatTheMapLeadsTo) {
  // A face inside the surface leads to one that has only the vertex in the middle in common with it.
  const VectorField field = fieldOf(grid(2), [](const Vec3&) { return Vec3(1.0, 0.0, 0.0); });
  const TriangleMesh& mesh = field.mesh();
  Index centre = kNone;
  for (Index v = 0; v < mesh.vertexCount(); ++v) centre = mesh.point(v).norm() < 1e-9 ? v : centre;
  std::vector<Index> around;
  Index from = kNone;
  for (Index h = mesh.outgoing(centre); h != kNone; h = mesh.nextOutgoing(h)) {
    around.push_back(TriangleMesh::face(h));
    const Index opposite = mesh.twin(TriangleMesh::next(h));
    if (opposite != kNone) from = static_cast<Index>(around.size()) - 1;
  }
  ASSERT_EQ(around.size(), 6U);
  ASSERT_NE(from, kNone);
  const Index to = around[(from + 3) % 6];
  from = around[from];
  std::vector<std::vector<Index>> rows(mesh.faceCount());
  rows[from] = {std::min(from, to), std::max(from, to)};
  std::vector<Index> setOf(mesh.faceCount(), kNone);
  setOf[from] = 0;
  const FaceSets sets(std::move(setOf), 1);
  const IndexPair pair = mapPair(field, mapFromRows(rows), sets, 0);
  EXPECT_EQ(pair.corners, Corners::Together);
  EXPECT_TRUE(std::binary_search(pair.exitVertices.begin(), pair.exitVertices.end(), centre));
  // The disk relative to one boundary point has no homology.
  EXPECT_EQ(conleyIndex(mesh, sets, 0, pair), (ConleyIndex{0, 0, 0}));
}

// At the boundary of the surface
// ----------------------------------------------------------------------------------------

/// One triangle; its first edge goes from (0, 0) to (1, 0), and inwards is upwards.
VectorField onTriangle(const Vec3& atTail, const Vec3& atHead, const Vec3& above) {
  const Surface s = surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  Points vectors(3, 3);
  vectors.row(0) = atTail;
  vectors.row(1) = atHead;
  vectors.row(2) = above;
  return fromSpace(makeCharts(s), vectors);
}

TEST(ExitSet, OfABoundaryEdgeIsThePieceOverWhichFlowLeaves) {
  const auto exitFor = [](double tail, double head) {
    const VectorField field = onTriangle({1, tail, 0}, {1, head, 0}, {1, 0, 0});
    return flowPair(field, geometryMap(field), allFaces(field.mesh()), 0).exits[0];
  };
  EXPECT_EQ(exitFor(1, 1), Exit::None);
  EXPECT_EQ(exitFor(-1, -1), Exit::Whole);
  EXPECT_EQ(exitFor(-1, 1), Exit::AtTail);
  EXPECT_EQ(exitFor(1, -1), Exit::AtHead);
  // Where the flow is tangent at an end, the rest of the edge decides.
  EXPECT_EQ(exitFor(0, 1), Exit::None);
  EXPECT_EQ(exitFor(0, -1), Exit::Whole);
  EXPECT_EQ(exitFor(-1, 0), Exit::Whole);
  EXPECT_EQ(exitFor(0, 0), Exit::None);
}

TEST(ExitSet, TellsInternalFromExternalTangencies) {
  // Over the first edge flow leaves at one end and enters at the other; the other two edges are crossed one way.
  const auto count = [](const Vec3& tail, const Vec3& head, const Vec3& above) {
    const VectorField field = onTriangle(tail, head, above);
    return internalTangencies(field, allFaces(field.mesh()), 0);
  };
  // Leaves at the tail, moves to the head, enters there: the trajectory stays above the edge, inside.
  EXPECT_EQ(count({1, -1, 0}, {1, 1, 0}, {1, 1, 0}), 1);
  // The other way along, it comes from below and goes there.
  EXPECT_EQ(count({-1, -1, 0}, {-1, 1, 0}, {-1, 1, 0}), 0);
  EXPECT_EQ(count({1, 1, 0}, {1, -1, 0}, {1, 1, 0}), 0);
  EXPECT_EQ(count({1, 1, 0}, {1, 1, 0}, {1, 1, 0}), 0);
}

TEST(ExitSet, TouchesReflexBoundaryVerticesFromInside) {
  // An L: the square without the quarter x > 0, y > 0.
  const Surface s =
      surface({{-1, -1, 0}, {0, -1, 0}, {1, -1, 0}, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}},
              {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {3, 4, 7}, {3, 7, 6}});
  const auto count = [&](double x, double y) {
    const VectorField field = fieldOf(s, [&](const Vec3&) { return Vec3(x, y, 0.0); });
    return internalTangencies(field, allFaces(field.mesh()), 0);
  };
  EXPECT_EQ(count(1.0, -0.7), 1);
  EXPECT_EQ(count(-1.0, 0.7), 1);
  EXPECT_EQ(count(1.0, 0.7), 0);
  EXPECT_EQ(count(-1.0, -0.7), 0);
}

TEST(ExitSet, IndicesAreThePoincareSumLessTheInternalTangencies) {
  // Flow that passes has index (0, 0, 0) but for the tangency, whose piece of exit is a second component of L.
  const VectorField field = onTriangle({1, -1, 0}, {1, 1, 0}, {1, 1, 0});
  const FaceSets sets = allFaces(field.mesh());
  const ConleyIndex index = conleyIndex(field.mesh(), sets, 0, flowPair(field, geometryMap(field), sets, 0));
  EXPECT_EQ(index, (ConleyIndex{0, 1, 0}));
  EXPECT_EQ(index.euler(), 0 - internalTangencies(field, sets, 0));
}

}  // namespace
}  // namespace stormfield::test
