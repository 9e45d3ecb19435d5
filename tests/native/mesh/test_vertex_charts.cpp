#include "mesh/vertex_charts.h"

#include <gtest/gtest.h>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

TEST(VertexCharts, GoOnceAroundInteriorVertices) {
  for (const Surface& s : {bumpySphere(2, 0.4), torus(9, 7), plateWithHoles(2), grid(5, 0.3)}) {
    const auto charts = makeCharts(s);
    const TriangleMesh& mesh = charts->mesh();
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      EXPECT_EQ(charts->tailAngle(mesh.outgoing(v)), 0.0);
      const double wanted = mesh.isBoundaryVertex(v) ? charts->totalAngle(v) : 2.0 * kPi;
      EXPECT_NEAR(charts->scale(v) * charts->totalAngle(v), wanted, 1e-13);
    }
  }
}

TEST(VertexCharts, CarryBothWaysAlike) {
  for (const Surface& s : {bumpySphere(2, 0.4), severalComponents(), plateWithHoles(3), cylinder(8, 3)}) {
    const auto charts = makeCharts(s);
    const TriangleMesh& mesh = charts->mesh();
    for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
      expectNear(charts->transport(h), std::polar(1.0, charts->headAngle(h) - charts->tailAngle(h)), 1e-14);
      // The direction along the edge stays the direction along the edge.
      expectNear(charts->transport(h) * std::polar(1.0, charts->tailAngle(h)), std::polar(1.0, charts->headAngle(h)),
                 1e-14);
      if (mesh.twin(h) == kNone) continue;
      EXPECT_EQ(charts->transport(mesh.twin(h)), std::conj(charts->transport(h)));
      expectNear(std::polar(1.0, charts->tailAngle(mesh.twin(h))), -std::polar(1.0, charts->headAngle(h)), 1e-14);
    }
  }
}

TEST(VertexCharts, ArePlanarOnPlanes) {
  const auto charts = makeCharts(grid(6, 0.3));
  const TriangleMesh& mesh = charts->mesh();
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    const Vec3 along = (mesh.point(mesh.head(h)) - mesh.point(mesh.tail(h))).normalized();
    expectNear(charts->toSpace(mesh.tail(h), std::polar(1.0, charts->tailAngle(h))), along, 1e-13);
    expectNear(charts->toSpace(mesh.head(h), std::polar(1.0, charts->headAngle(h))), along, 1e-13);
    expectNear(charts->faceToSpace(TriangleMesh::face(h), std::polar(1.0, charts->faceAngle(h))), along, 1e-13);
  }
}

TEST(VertexCharts, FramesFitTheEdges) {
  const auto charts = makeCharts(bumpySphere(2, 0.2));
  const TriangleMesh& mesh = charts->mesh();
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_NEAR(charts->normal(v).norm(), 1.0, 1e-14);
    EXPECT_NEAR(charts->xAxis(v).norm(), 1.0, 1e-14);
    EXPECT_NEAR(charts->xAxis(v).dot(charts->normal(v)), 0.0, 1e-14);
    // No turn of the frame lowers the misfit: its derivative, the sum of the sines, vanishes.
    double sines = 0.0, cosines = 0.0;
    for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
      const Complex projected = charts->toTangent(v, mesh.point(mesh.head(h)) - mesh.point(v));
      const Complex misfit = projected / std::abs(projected) * std::polar(1.0, -charts->tailAngle(h));
      sines += misfit.imag();
      cosines += misfit.real();
    }
    EXPECT_NEAR(sines, 0.0, 1e-12);
    EXPECT_GT(cosines, 0.0);
  }
}

TEST(VertexCharts, ConvertToSpaceAndBack) {
  const auto charts = makeCharts(torus(9, 7));
  Random random(3);
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const Complex a(random.uniform(), random.uniform());
    expectNear(charts->toTangent(v, charts->toSpace(v, a)), a, 1e-14);
    EXPECT_NEAR(charts->toSpace(v, a).norm(), std::abs(a), 1e-14);
  }
  for (Index f = 0; f < charts->mesh().faceCount(); ++f) {
    const Complex a(random.uniform(), random.uniform());
    expectNear(charts->spaceToFace(f, charts->faceToSpace(f, a)), a, 1e-14);
  }
}

TEST(VertexCharts, GiveUnusedVerticesAFrame) {
  Surface s = tetrahedron();
  s.points.conservativeResize(5, 3);
  s.points.row(4).setConstant(9.0);
  const auto charts = makeCharts(s);
  EXPECT_NEAR(charts->xAxis(4).norm(), 1.0, 1e-15);
  EXPECT_EQ(charts->scale(4), 1.0);
}

}  // namespace
}  // namespace stormfield::test
