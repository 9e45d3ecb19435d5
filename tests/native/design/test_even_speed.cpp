#include "design/even_speed.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "base/error.h"
#include "field/poincare_index.h"
#include "fixtures.h"

namespace stormfield {
namespace {

ParameterizedField constantInLambda(const VectorField& field) {
  std::vector<Complex> values = field.values;
  values.insert(values.end(), field.values.begin(), field.values.end());
  return {field.charts, {0.0, 1.0}, values};
}

TEST(EvenSpeed, KeepsDirectionsAndIndices) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    for (const auto& charts :
         {test::makeCharts(test::dividedIcosahedron(10)), test::makeCharts(test::torus(20, 12, 1.0, 0.4, 0.2))}) {
      const ParameterizedField field = constantInLambda(test::randomField(charts, seed));
      const ParameterizedField even = evenSpeed(field, 1.0, 0.05);
      for (Index j = 0; j < 2; ++j) {
        EXPECT_EQ(poincareIndices(*charts, field.sample(j)), poincareIndices(*charts, even.sample(j)));
      }
      for (std::size_t k = 0; k < field.values.size(); ++k) {
        const Complex ratio = even.values[k] / field.values[k];
        EXPECT_GT(ratio.real(), 0.0);
        EXPECT_NEAR(ratio.imag(), 0.0, 1e-12 * ratio.real());
      }
    }
  }
}

TEST(EvenSpeed, ZeroAmountChangesNothing) {
  const ParameterizedField field =
      constantInLambda(test::randomField(test::makeCharts(test::dividedIcosahedron(5)), 1));
  EXPECT_EQ(evenSpeed(field, 0.0, 0.1).values, field.values);
}

TEST(EvenSpeed, IsUnitSpeedWhereTheFieldHasFaded) {
  // A field along x whose speed falls from 1 to 1e-6 over the square.
  const auto square = test::makeCharts(test::grid(60));
  const VectorField field = sampled(square, [](const Vec3& p) { return Vec3(std::exp(-6.9 * (1.0 + p.x())), 0, 0); });
  const ParameterizedField even = evenSpeed(constantInLambda(field), 1.0, 0.01);
  const auto [slowest, fastest] = std::minmax_element(even.values.begin(), even.values.end(),
                                                      [](Complex a, Complex b) { return std::norm(a) < std::norm(b); });
  EXPECT_GT(std::abs(*slowest) / std::abs(*fastest), 0.98);
  EXPECT_GT(std::abs(*slowest), 0.1);
}

TEST(EvenSpeed, FallsLinearlyToAFixedPointAtAnyResolution) {
  // V = (-y, x): the speed after evening is U r / sqrt(r^2 + reach^2).
  const double reach = 0.2;
  for (const Index n : {20, 40, 80}) {
    const auto square = test::makeCharts(test::grid(n, 0.2));
    const VectorField field = sampled(square, [](const Vec3& p) { return Vec3(-p.y(), p.x(), 0); });
    const ParameterizedField even = evenSpeed(constantInLambda(field), 1.0, reach);
    const TriangleMesh& mesh = square->mesh();
    double speed = 0.0, area = 0.0;
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      speed += mesh.vertexArea(v) * mesh.point(v).squaredNorm();
      area += mesh.vertexArea(v) * mesh.point(v).norm();
    }
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      const double r = mesh.point(v).norm();
      if (mesh.point(v).cwiseAbs().maxCoeff() > 0.9) continue;
      EXPECT_NEAR(std::abs(even.values[v]), speed / area * r / std::hypot(r, reach), 0.04);
    }
  }
}

TEST(EvenSpeed, AcceptsZeroFieldsAndRefusesBadSettings) {
  const auto sphere = test::makeCharts(test::dividedIcosahedron(4));
  const ParameterizedField zero =
      constantInLambda({sphere, std::vector<Complex>(sphere->mesh().vertexCount(), Complex{})});
  EXPECT_EQ(evenSpeed(zero, 1.0, 0.1).values, zero.values);
  EXPECT_THROW(evenSpeed(zero, -0.1, 0.1), InputError);
  EXPECT_THROW(evenSpeed(zero, 1.1, 0.1), InputError);
  EXPECT_THROW(evenSpeed(zero, 0.5, 0.0), InputError);
  EXPECT_THROW(evenSpeed(zero, 0.5, std::nan("")), InputError);
}

}  // namespace
}  // namespace stormfield
