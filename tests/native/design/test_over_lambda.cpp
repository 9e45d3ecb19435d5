// Numbers of an element that change over lambda, and its fades.
#include <gtest/gtest.h>

#include <cmath>

#include "field/interpolation.h"
#include "storm_checks.h"

namespace stormfield {
namespace {

using storms::singular;

std::string fault(const DesignElement& element) {
  try {
    checkElements({element});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

DesignElement vortex() {
  return singular("eye", SingularKind::VortexCcw, {{1, 0, 0}}, {0.0, 0.25, 0.5, 1.0}, 0.4);
}

TEST(OverLambda, IsLinearInBetween) {
  const OverLambda number(std::vector<double>{1.0, 3.0, 3.0, 0.0});
  const std::vector<double> lambdas = {0.2, 0.4, 0.4, 0.8};
  EXPECT_DOUBLE_EQ(number.at(lambdas, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(number.at(lambdas, 0.3), 2.0);
  EXPECT_DOUBLE_EQ(number.at(lambdas, 0.4), 3.0);
  EXPECT_DOUBLE_EQ(number.at(lambdas, 0.6), 1.5);
  EXPECT_DOUBLE_EQ(number.at(lambdas, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(OverLambda(2.5).at(lambdas, 0.3), 2.5);
}

TEST(OverLambda, AStormSpinsUpAndDecays) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  DesignElement element = vortex();
  element.strength = std::vector<double>{0.1, 0.2, 0.2, 0.1};
  const Index samples = 41;
  const auto result = storms::solved(charts, {element}, samples);
  const ClosestPointQuery query(charts->meshPointer());
  for (Index j = 0; j < samples; ++j) {
    const double lambda = result.field.lambdas[j];
    const double wanted = element.strength.at(element.lambdas, lambda) * charts->mesh().size();
    const Vec3 beside = Vec3(1.0, 0.2, 0.0).normalized();
    const double core = element.radius.largest() / 3.0, away = std::asin(beside.y());
    const double speed = evaluate(sampleField(result.field, j), query.closest(beside).point).norm();
    EXPECT_NEAR(speed, wanted * away / std::hypot(away, core), 0.08 * wanted + 0.01) << lambda;
  }
}

TEST(OverLambda, WhereStrengthIsZeroTheElementLetsGo) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(8));
  DesignElement element = vortex();
  element.strength = std::vector<double>{0.0, 0.2, 0.0, 0.0};
  ElementOptions options;
  options.samples = 9;
  const ConstraintSet set = elementConstraints(charts, {element}, options);
  for (const Index j : set.sample) EXPECT_TRUE(j > 0 && j < 4) << j;
  EXPECT_GT(set.size(), 0u);
}

TEST(OverLambda, FadesAreStrengthsThatGrowAndFall) {
  DesignElement element = singular("eye", SingularKind::VortexCcw, {{1, 0, 0}}, {0.2, 0.8}, 0.4);
  element.fadeIn = 0.2;
  element.fadeOut = 0.1;
  EXPECT_DOUBLE_EQ(strengthAt(element, 0.2), 0.0);
  EXPECT_NEAR(strengthAt(element, 0.3), 0.1, 1e-12);
  EXPECT_NEAR(strengthAt(element, 0.5), 0.2, 1e-12);
  EXPECT_NEAR(strengthAt(element, 0.75), 0.1, 1e-12);
  EXPECT_NEAR(holdAt(element, 0.3), 0.25, 1e-12);
  EXPECT_DOUBLE_EQ(holdAt(element, 0.9), 0.0);
}

TEST(OverLambda, RadiusAndAngleChangeToo) {
  const auto charts = test::makeCharts(test::grid(20));
  DesignElement saddle = singular("s", SingularKind::Saddle, {{0, 0, 0}}, {0.0, 1.0}, 0.5);
  saddle.angle = std::vector<double>{0.0, 1.0};
  saddle.radius = std::vector<double>{0.33, 0.63};
  const auto result = storms::solved(charts, {saddle}, 5);
  const ClosestPointQuery query(charts->meshPointer());
  for (Index j = 0; j < 5; ++j) {
    const double angle = result.field.lambdas[j];
    const Vec3 axis(std::cos(angle), std::sin(angle), 0.0);
    const Vec3 v = evaluate(sampleField(result.field, j), query.closest(Vec3(0.15 * axis)).point).normalized();
    EXPECT_GT(v.dot(axis), 0.99) << j;
  }
  ElementOptions options;
  options.samples = 2;
  const ConstraintSet set = elementConstraints(charts, {saddle}, options);
  for (std::size_t i = 0; i < set.size(); ++i)
    EXPECT_LT(charts->mesh().point(set.vertex[i]).norm(), set.sample[i] == 0 ? 0.33 : 0.63);
}

TEST(OverLambda, BadNumbersAreRefused) {
  const auto with = [](const auto& change) {
    DesignElement element = vortex();
    element.strength = std::vector<double>{0.1, 0.1, 0.1, 0.2};
    change(element);
    return fault(element);
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_EQ(with([](auto& e) {
              e.radius = std::vector<double>{1.0, 2.0};
            }),
            "singular element \"eye\" has 2 values of radius for 4 lambda values: give one number, or one per lambda "
            "value");
  EXPECT_EQ(with([](auto& e) {
              e.strength = std::vector<double>{0.1, -0.1, 0.1, 0.2};
            }),
            "singular element \"eye\" has strength -0.1: a strength never falls below 0; end the element where it is 0 "
            "and begin its opposite there");
  EXPECT_EQ(with([](auto& e) {
              e.strength = std::vector<double>{0.0, 0.0, 0.0, 0.0};
            }),
            "singular element \"eye\" has strength 0 at every lambda: give a number above 0 somewhere");
  EXPECT_EQ(with([](auto& e) { e.fadeIn = 0.7, e.fadeOut = 0.6; }),
            "singular element \"eye\" fades over 1.3 of lambda, but lives for 1: make its fades shorter");
  EXPECT_NE(with([](auto& e) { e.strength = 0.2; }).find("has 4 lambda values for 1 points"), std::string::npos);
}

}  // namespace
}  // namespace stormfield
