// Analytic fields against what their descriptions promise.
#include "field/analytic_fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "checks.h"
#include "field/poincare_index.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

TEST(AnalyticFields, AreSampledAtTheVerticesWithoutTheirNormalPart) {
  const auto charts = makeCharts(icosphere(2));
  const VectorField field = sampled(charts, [](const Vec3& p) { return Vec3(Vec3::UnitZ().cross(p) + 3.0 * p); });
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const Vec3 n = charts->normal(v),
               whole = Vec3::UnitZ().cross(charts->mesh().point(v)) + 3.0 * charts->mesh().point(v);
    expectNear(charts->toSpace(v, field.values[v]), whole - whole.dot(n) * n, 1e-12);
  }
  const ParameterizedField turning = sampled(
      charts, evenLambdas(3), [](const Vec3& p, double lambda) { return Vec3(Vec3(lambda, 0.0, 1.0).cross(p)); });
  EXPECT_EQ(sampleField(turning, 1).values, sampled(charts, analytic::rotation({0.5, 0.0, 1.0})).values);
  expectFault<InputError>([&] { sampled(charts, analytic::uniform({std::nan(""), 0.0, 0.0})); }, {"vertex 0"});
}

TEST(AnalyticFields, LambdasAreEven) {
  EXPECT_EQ(evenLambdas(1), std::vector<double>{0.0});
  EXPECT_EQ(evenLambdas(5), (std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0}));
}

TEST(AnalyticFields, HopfHasItsOrbit) {
  for (const double rotation : {1.0, -0.7}) {
    const SpaceField field = analytic::hopf(0.25, rotation);
    for (double angle = 0.0; angle < 6.0; angle += 0.5) {
      const Vec3 on(0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.0);
      expectNear(field(on), rotation * Vec3::UnitZ().cross(on), 1e-15);
      EXPECT_GT(field(0.9 * on).dot(on), 0.0);  // attracting from inside
      EXPECT_LT(field(1.1 * on).dot(on), 0.0);
    }
  }
  expectNear(analytic::hopf(-0.1, 1.0)(Vec3(0.2, 0.0, 0.0)), Vec3(-0.028, 0.2, 0.0), 1e-15);
}

TEST(AnalyticFields, NormalFormsVanishWhereTheyShould) {
  EXPECT_LT(analytic::foldForm(0.3, 0.0, 0.09).norm(), 1e-15);
  EXPECT_LT(analytic::foldForm(-0.3, 0.0, 0.09).norm(), 1e-15);
  EXPECT_GT(analytic::foldForm(-0.3 + 1e-3, 0.0, 0.09).x(), 0.0);  // away from the saddle, towards the sink
  EXPECT_LT(analytic::foldForm(0.3 + 1e-3, 0.0, 0.09).x(), 0.0);
  EXPECT_EQ(analytic::hopfForm(0.0, 0.0, 0.3).norm(), 0.0);

  analytic::Placement placement;
  placement.place = {0.2, -0.1};
  placement.angle = 0.8;
  placement.size = 0.5;
  placement.lambda = 0.4;
  placement.drift = {0.3, 0.0};
  const SpaceFieldOverLambda field = placement.field(analytic::foldForm);
  const double mu = 0.9 - 0.4;
  const Eigen::Vector2d sink =
      placement.place + mu * placement.drift + 0.5 * std::sqrt(mu) * Eigen::Vector2d(std::cos(0.8), std::sin(0.8));
  EXPECT_LT(field(Vec3(sink.x(), sink.y(), 0.0), 0.9).norm(), 1e-14);
}

TEST(AnalyticFields, RotationsHaveTwoCentersAndSwirlsAddUp) {
  const auto charts = makeCharts(icosphere(3));
  const std::vector<int> rotation = poincareIndices(sampled(charts, analytic::rotation({0.1, 0.3, 1.0})));
  EXPECT_EQ(sum(rotation), 2);
  EXPECT_EQ(std::count(rotation.begin(), rotation.end(), 1), 2);
  for (const double phase : {0.0, 1.0}) EXPECT_EQ(sum(poincareIndices(sampled(charts, analytic::swirl(phase)))), 2);
}

}  // namespace
}  // namespace stormfield::test
