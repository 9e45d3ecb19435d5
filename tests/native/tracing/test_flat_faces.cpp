#include <gtest/gtest.h>

#include "field/interpolation.h"
#include "fixtures.h"
#include "tracing/flat_faces.h"

namespace stormfield {
namespace {

/// Largest difference to the reference interpolation, as a fraction of the face's fastest vertex.
double worstDifference(const test::ChartsPointer& charts) {
  const VectorField field = test::randomField(charts, 3);
  const FlatFaces faces(charts);
  double worst = 0.0;
  for (const SurfacePoint& p : test::randomSeeds(charts->mesh(), 3000, 5)) {
    const FaceInterpolant reference = faceInterpolant(field, p.face);
    const FlatFace& face = faces[p.face];
    const auto value = [&](int i) { return field.values[charts->mesh().vertex(p.face, i)]; };
    const CarriedVectors u = face.carry(value(0), value(1), value(2));
    const Complex point = face.point(p.barycentric);
    EXPECT_NEAR(std::abs(point - reference.point(p.barycentric)), 0.0, 1e-12);
    EXPECT_NEAR((face.barycentric(point) - p.barycentric).norm(), 0.0, 1e-12);
    const double fastest = std::max({std::abs(value(0)), std::abs(value(1)), std::abs(value(2))});
    worst = std::max(worst, std::abs(face.evaluate(u, point) - reference.evaluate(point)) / fastest);
  }
  return worst;
}

TEST(FlatFaces, AgreeWithTheReferenceInterpolation) {
  EXPECT_LT(worstDifference(test::makeCharts(test::dividedIcosahedron(12))), 1e-8);
  EXPECT_LT(worstDifference(test::makeCharts(test::torus(24, 12, 1.0, 0.4, 0.3))), 2e-7);
  EXPECT_LT(worstDifference(test::makeCharts(test::cube())), 1e-6);
  EXPECT_LT(worstDifference(test::makeCharts(test::grid(9, 0.3))), 1e-14);
}

TEST(FlatFaces, ScaleOfTheMeshDoesNotMatter) {
  for (const double scale : {1e-12, 1e12}) {
    const auto unit = test::makeCharts(test::dividedIcosahedron(4));
    EXPECT_LT(worstDifference(test::makeCharts({unit->mesh().points() * scale, unit->mesh().triangles()})), 1e-7);
  }
}

}  // namespace
}  // namespace stormfield
