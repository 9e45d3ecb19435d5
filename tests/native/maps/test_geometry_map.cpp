#include "maps/geometry_map.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <functional>

#include "checks.h"
#include "field/interpolation.h"
#include "field/poincare_index.h"
#include "fixtures.h"
#include "maps/fixed_point_faces.h"
#include "tracing/streamline.h"

namespace stormfield::test {
namespace {

bool leads(const CombinatorialMap& map, Index a, Index b) {
  return std::binary_search(map.graph.begin(a), map.graph.end(a), b);
}

VectorField spaceField(const Surface& s, const std::function<Vec3(const Vec3&)>& function) {
  const auto charts = makeCharts(s);
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = function(s.points.row(v));
  return fromSpace(charts, vectors);
}

TEST(EdgeDirections, AgreeWithTheFieldAlongTheEdge) {
  for (const NamedSurface& s : closedSurfaces()) {
    const VectorField field = randomField(makeCharts(s.surface), 5);
    const TriangleMesh& mesh = field.mesh();
    const auto directions = edgeDirections(field);
    for (Index e = 0; e < mesh.edgeCount(); ++e) {
      const Index h = mesh.edgeHalfedge(e), f = TriangleMesh::face(h);
      const FaceInterpolant local = faceInterpolant(field, f);
      const int tail = TriangleMesh::corner(h), head = (tail + 1) % 3;
      const Complex along = local.corners[head] - local.corners[tail];
      EdgeDirections seen;
      for (int i = 1; i < 200; ++i) {
        const Complex v = local.evaluate(local.corners[tail] + i / 200.0 * along) * std::conj(along);
        (v.imag() > 0.0 ? seen.inwards : seen.outwards) = true;
      }
      // Samples can miss a change of sign just beside an end.
      EXPECT_TRUE(directions[e].inwards || !seen.inwards) << s.name << ", edge " << e;
      EXPECT_TRUE(directions[e].outwards || !seen.outwards) << s.name << ", edge " << e;
      EXPECT_TRUE(directions[e].inwards || directions[e].outwards);
    }
  }
}

TEST(EdgeDirections, FollowFromTheEndsOfALinearField) {
  // V = (1, x - 0.1): flow crosses lines x = const to the right, and lines y = const up where x > 0.1.
  const VectorField field = spaceField(grid(8, 0.2), [](const Vec3& p) { return Vec3(1.0, p.x() - 0.1, 0.0); });
  const TriangleMesh& mesh = field.mesh();
  const auto directions = edgeDirections(field);
  int bothWays = 0;
  for (Index e = 0; e < mesh.edgeCount(); ++e) {
    const Index h = mesh.edgeHalfedge(e);
    const Vec3 tail = mesh.point(mesh.tail(h)), head = mesh.point(mesh.head(h)), along = head - tail;
    const auto across = [&](const Vec3& p) { return along.x() * (p.x() - 0.1) - along.y(); };
    EXPECT_EQ(directions[e].inwards, across(tail) > 0.0 || across(head) > 0.0) << e;
    EXPECT_EQ(directions[e].outwards, across(tail) < 0.0 || across(head) < 0.0) << e;
    bothWays += directions[e].inwards && directions[e].outwards;
  }
  EXPECT_GT(bothWays, 8);
}

TEST(EdgeDirections, ComeFromTheEndVectorsInTheFrameOfTheHalfedge) {
  const VectorField field = spaceField(grid(4, 0.2), [](const Vec3& p) { return Vec3(2.0 - p.y(), p.x(), 0.0); });
  const TriangleMesh& mesh = field.mesh();
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    const Vec3 tail = mesh.point(mesh.tail(h)), head = mesh.point(mesh.head(h));
    const Vec3 along = (head - tail).normalized(), across(-along.y(), along.x(), 0.0);
    const auto inFrame = [&](const Vec3& p) {
      const Vec3 v(2.0 - p.y(), p.x(), 0.0);
      return Complex(v.dot(along), v.dot(across));
    };
    const EndVectors ends = endVectors(field, h);
    expectNear(ends.tail, inFrame(tail), 1e-12);
    expectNear(ends.head, inFrame(head), 1e-12);
  }
}

TEST(EdgeDirections, AFixedPointOnAnEdgeIsCrossedBothWays) {
  EXPECT_TRUE(holdsFixedPointOnEdge({0.0, {1.0, 1.0}}));
  EXPECT_TRUE(holdsFixedPointOnEdge({{1.0, 1.0}, 0.0}));
  EXPECT_TRUE(holdsFixedPointOnEdge({1.0, -2.0}));
  EXPECT_FALSE(holdsFixedPointOnEdge({1.0, 2.0}));                 // along the edge
  EXPECT_FALSE(holdsFixedPointOnEdge({{1.0, 0.5}, {-1.0, 0.5}}));  // crosses it
  EXPECT_FALSE(holdsFixedPointOnEdge({{1.0, 1e-12}, {-1.0, 0.0}}));
  // V = (x - 0.1, 0) is zero between the ends of the edges along x there.
  const VectorField field = spaceField(grid(8), [](const Vec3& p) { return Vec3(p.x() - 0.1, 0.0, 0.0); });
  const TriangleMesh& mesh = field.mesh();
  const auto directions = edgeDirections(field);
  const std::vector<char> holds = fixedPointFaces(field);
  int found = 0;
  for (Index e = 0; e < mesh.edgeCount(); ++e) {
    const Index h = mesh.edgeHalfedge(e);
    const Vec3 tail = mesh.point(mesh.tail(h)), head = mesh.point(mesh.head(h));
    if (tail.y() != head.y() || (tail.x() - 0.1) * (head.x() - 0.1) > 0.0) continue;
    ++found;
    EXPECT_TRUE(directions[e].inwards && directions[e].outwards) << e;
    for (const Index side : {h, mesh.twin(h)}) {
      if (side != kNone) {
        EXPECT_TRUE(holds[TriangleMesh::face(side)]) << e;
      }
    }
  }
  EXPECT_EQ(found, 9);
}

TEST(GeometryMap, EnclosesStreamlines) {
  for (const NamedSurface& s : closedSurfaces()) {
    const VectorField field = randomField(makeCharts(s.surface), 6);
    const CombinatorialMap map = geometryMap(field);
    const FlatFaces faces(field.charts);
    Random random(3);
    std::vector<SurfacePoint> seeds(100);
    for (SurfacePoint& seed : seeds) seed = {random.below(field.mesh().faceCount()), random.barycentric(0.01)};
    const Traces traces = traceStreamlines(faces, field, seeds, {.maxLength = 3.0});
    for (std::size_t t = 0; t < seeds.size(); ++t) {
      for (std::size_t i = traces.offsets[t] + 1; i < traces.offsets[t + 1]; ++i) {
        const Index a = traces.points[i - 1].face, b = traces.points[i].face;
        const bool atVertex = traces.points[i].barycentric.maxCoeff() > 1.0 - 1e-6;
        if (a != b && !atVertex) {
          EXPECT_TRUE(leads(map, a, b)) << s.name << ": " << a << " -> " << b;
        }
      }
    }
  }
}

TEST(GeometryMap, LeadsOverTheBoundaryToOutside) {
  const VectorField field = spaceField(grid(4), [](const Vec3&) { return Vec3(1.0, 0.3, 0.0); });
  const TriangleMesh& mesh = field.mesh();
  const CombinatorialMap map = geometryMap(field);
  ASSERT_EQ(map.graph.nodeCount(), mesh.faceCount() + 1);
  EXPECT_EQ(map.graph.begin(map.outside()), map.graph.end(map.outside()));
  int leaving = 0;
  for (Index f = 0; f < mesh.faceCount(); ++f) leaving += leads(map, f, map.outside());
  EXPECT_EQ(leaving, 4 + 4);  // on the right and on the upper side
  EXPECT_EQ(stronglyConnectedComponents(map.graph).count(), map.graph.nodeCount());
}

TEST(GeometryMap, OfAFlowAlongEdgesHasNoCycles) {
  // Round-off across the edges does not count as flow.
  for (const double angle : {0.0, 0.5 * kPi, 0.25 * kPi}) {
    const VectorField field =
        spaceField(grid(6), [&](const Vec3&) { return Vec3(std::cos(angle), std::sin(angle), 0.0); });
    const CombinatorialMap map = geometryMap(field);
    EXPECT_EQ(stronglyConnectedComponents(map.graph).count(), map.graph.nodeCount()) << angle;
  }
}

TEST(GeometryMap, OfAZeroFieldIsOneComponent) {
  const VectorField field = zeroField(makeCharts(icosphere(1)));
  const Components components = stronglyConnectedComponents(geometryMap(field).graph);
  EXPECT_EQ(components.count(), 2);  // and outside
}

TEST(GeometryMap, JoinsTheFacesAroundAFixedPointAtAVertex) {
  for (const double sign : {1.0, -1.0}) {
    const VectorField field = spaceField(grid(4), [&](const Vec3& p) { return Vec3(sign * p); });
    const Components components = stronglyConnectedComponents(geometryMap(field).graph);
    EXPECT_EQ(*std::max_element(components.sizes.begin(), components.sizes.end()), 6);
    EXPECT_EQ(std::count(components.recurrent.begin(), components.recurrent.end(), 1), 1);
  }
}

TEST(GeometryMap, HasALoopWhereTheFieldWinds) {
  for (const NamedSurface& s : closedSurfaces()) {
    const VectorField field = randomField(makeCharts(s.surface), 8);
    const std::vector<int> indices = poincareIndices(field);
    const CombinatorialMap map = geometryMap(field);
    for (Index f = 0; f < field.mesh().faceCount(); ++f) EXPECT_EQ(leads(map, f, f), indices[f] != 0) << s.name;
  }
}

TEST(GeometryMap, OfTheReversedFieldIsReversed) {
  for (const NamedSurface& s : closedSurfaces()) {
    for (const auto& field : {randomField(makeCharts(s.surface), 9), randomIntegerField(makeCharts(s.surface), 9)}) {
      VectorField back = field;
      for (Complex& v : back.values) v = -v;
      const DirectedGraph backwards = reversed(geometryMap(field).graph), wanted = geometryMap(back).graph;
      EXPECT_EQ(backwards.offsets, wanted.offsets) << s.name;
      EXPECT_EQ(backwards.targets, wanted.targets) << s.name;
    }
  }
}

TEST(GeometryMap, DoesNotDependOnThreads) {
  const VectorField field = randomField(makeCharts(bumpySphere(4)), 10);
  const CombinatorialMap map = geometryMap(field);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(geometryMap(field).graph.targets, map.graph.targets);
}

}  // namespace
}  // namespace stormfield::test
