#include "field/interpolation.h"

#include <gtest/gtest.h>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

/// The field at a point of halfedge h (t of the way), relative to the direction along h.
Complex alongEdge(const VectorField& field, Index h, double t) {
  const int k = TriangleMesh::corner(h);
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  b[k] = 1.0 - t;
  b[(k + 1) % 3] = t;
  const FaceInterpolant local = faceInterpolant(field, TriangleMesh::face(h));
  return local.evaluate(local.point(b)) * std::polar(1.0, -field.charts->faceAngle(h));
}

TEST(Interpolation, IsContinuousAcrossEdges) {
  Random random(2);
  for (const Surface& s : {bumpySphere(2, 0.4), tetrahedron(), torus(9, 7), plateWithHoles(3), uvSphere(7, 12)}) {
    const VectorField field = randomField(makeCharts(s), 5);
    const TriangleMesh& mesh = field.mesh();
    for (Index e = 0; e < mesh.edgeCount(); ++e) {
      const Index h = mesh.edgeHalfedge(e), t = mesh.twin(h);
      const double where = random.uniform(0.001, 0.999);
      const Complex here = alongEdge(field, h, where);
      expectNear(here, -alongEdge(field, t, 1.0 - where), 1e-12);
      // The linear blend of the two ends, each carried along the edge.
      const Complex tail = field.values[mesh.tail(h)] * std::polar(1.0, -field.charts->tailAngle(h));
      const Complex head = field.values[mesh.head(h)] * std::polar(1.0, -field.charts->headAngle(h));
      expectNear(here, (1.0 - where) * tail + where * head, 1e-12);
    }
  }
}

TEST(Interpolation, IsLinearOnFlatMeshes) {
  Random random(3);
  for (const Surface& s : {grid(7, 0.35), annulus(9, 4)}) {
    const VectorField field = randomField(makeCharts(s), 8);
    const Points vectors = toSpace(field);
    for (int i = 0; i < 300; ++i) {
      const SurfacePoint p{random.below(field.mesh().faceCount()), random.barycentric()};
      Vec3 wanted = Vec3::Zero();
      for (int k = 0; k < 3; ++k) wanted += p.barycentric[k] * vectors.row(field.mesh().vertex(p.face, k)).transpose();
      expectNear(evaluate(field, p), wanted, 1e-13);
    }
  }
}

TEST(Interpolation, ReachesTheVertexVectorsAlongEveryEdge) {
  const VectorField field = randomField(makeCharts(bumpySphere(1, 0.4)), 4);
  const TriangleMesh& mesh = field.mesh();
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    expectNear(alongEdge(field, h, 1e-7) * std::polar(1.0, field.charts->tailAngle(h)), field.values[mesh.tail(h)],
               1e-6);
  }
}

TEST(Interpolation, JacobianMatchesFiniteDifferences) {
  Random random(6);
  for (const Surface& s : {bumpySphere(2, 0.4), tetrahedron(), grid(5, 0.3), plateWithHoles(2)}) {
    const VectorField field = randomField(makeCharts(s), 9);
    for (int i = 0; i < 200; ++i) {
      const FaceInterpolant local = faceInterpolant(field, random.below(field.mesh().faceCount()));
      const Complex p = local.point(random.barycentric(0.05));
      const double step = 1e-5 * std::sqrt(local.doubleArea);
      const Complex dx = (local.evaluate(p + step) - local.evaluate(p - step)) / (2.0 * step);
      const Complex dy = (local.evaluate(p + Complex(0, step)) - local.evaluate(p - Complex(0, step))) / (2.0 * step);
      const Eigen::Matrix2d j = local.jacobian(p);
      const double tolerance = 1e-7 * (1.0 + j.norm());
      expectNear(Complex(j(0, 0), j(1, 0)), dx, tolerance);
      expectNear(Complex(j(0, 1), j(1, 1)), dy, tolerance);
    }
  }
}

TEST(Interpolation, BarycentricCoordinatesInvertPoints) {
  Random random(1);
  const VectorField field = randomField(makeCharts(bumpySphere(1, 0.4)), 1);
  for (Index f = 0; f < field.mesh().faceCount(); ++f) {
    const FaceInterpolant local = faceInterpolant(field, f);
    const Eigen::Vector3d b = random.barycentric();
    expectNear(local.barycentric(local.point(b)), b, 1e-14);
    for (int k = 0; k < 3; ++k) {
      const double length = field.mesh().edgeLength(field.mesh().edge(3 * f + k));
      EXPECT_NEAR(std::abs(local.corners[(k + 1) % 3] - local.corners[k]), length, 1e-14);
    }
  }
}

TEST(Interpolation, TurnsWithTheScene) {
  const Surface s = bumpySphere(2, 0.3);
  const VectorField field = randomField(makeCharts(s), 3);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const VectorField turned =
      fromSpace(makeCharts({s.points * turn.transpose(), s.triangles}), toSpace(field) * turn.transpose());
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const SurfacePoint p{random.below(field.mesh().faceCount()), random.barycentric()};
    expectNear(evaluate(turned, p), turn * evaluate(field, p), 1e-12);
  }
}

}  // namespace
}  // namespace stormfield::test
