// Attachment and separation: eq. 5.2 and 5.3 at the constraints, and rates of convergence in the solved field.
#include <gtest/gtest.h>

#include <cmath>

#include "design/log_map.h"
#include "field/interpolation.h"
#include "storm_checks.h"

namespace stormfield {
namespace {

DesignElement line(ElementType type, std::vector<Vec3> points, double radius, double rate) {
  DesignElement element;
  element.name = "line";
  element.type = type;
  element.points = std::move(points);
  element.radius = radius;
  element.rate = rate;
  return element;
}

ConstraintSet constraints(const test::ChartsPointer& charts, const DesignElement& element) {
  ElementOptions options;
  options.samples = 1;
  return elementConstraints(charts, {element}, options);
}

TEST(Lines, AnElementAtAPointIsTheFormulaOfTheThesis) {
  const auto charts = test::makeCharts(test::grid(24, 0.3));
  const ClosestPointQuery query(charts->meshPointer());
  LogMapScratch scratch(charts->mesh());
  for (const double turn : {0.0, 0.7, 2.5}) {
    const Vec3 along(std::cos(turn), std::sin(turn), 0.0), left(-along.y(), along.x(), 0.0), centre(0.05, -0.03, 0.0);
    const LogMap map = logMap(*charts, query.closest(centre).point, 0.4, scratch);
    const Complex u = charts->spaceToFace(map.source.face, along);
    for (const ElementType type : {ElementType::Attachment, ElementType::Separation}) {
      DesignElement element = line(type, {centre}, 0.4, 1.5);
      element.direction = along;
      const double c = type == ElementType::Attachment ? -1.5 : 1.5;
      const double speed = element.strength.largest() * charts->mesh().size();
      const ConstraintSet set = constraints(charts, element);
      ASSERT_GT(set.size(), 20u);
      for (std::size_t i = 0; i < set.size(); ++i) {
        // Exact in the logarithmic map of the place, and in the plane as exact as that map.
        const LogMapEntry& entry = *map.find(set.vertex[i]);
        const double lateral = (std::conj(u) * std::polar(entry.distance, entry.angle)).imag();
        EXPECT_LT(std::abs(set.value[i] - (speed * u + c * lateral * Complex(0.0, 1.0) * u) * entry.frame()), 1e-12);
        const double offset = (charts->mesh().point(set.vertex[i]) - centre).dot(left);
        const Vec3 wanted = speed * along + c * offset * left;
        EXPECT_LT((charts->toSpace(set.vertex[i], set.value[i]) - wanted).norm(), 0.03 * speed);
      }
    }
  }
}

TEST(Lines, RateZeroIsARegularElement) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  DesignElement element = line(ElementType::Attachment, {{1, 0, 0}}, 0.4, 0.0);
  element.direction = Vec3(0, 1, 1);
  const ConstraintSet attachment = constraints(charts, element);
  element.type = ElementType::Regular;
  const ConstraintSet regular = constraints(charts, element);
  EXPECT_EQ(attachment.value, regular.value);
  EXPECT_EQ(attachment.weight, regular.weight);
}

/// Speed towards the left of a point of a curve, over its distance from it, in the solved field.
void checkRates(const test::ChartsPointer& charts, const DesignElement& element, const std::vector<Vec3>& places,
                const std::vector<Vec3>& along, const std::vector<Vec3>& left, double step) {
  const auto field = sampleField(storms::solved(charts, {element}, 2, 1e-6).field, 0);
  const ClosestPointQuery query(charts->meshPointer());
  const double c = element.type == ElementType::Attachment ? -element.rate.largest() : element.rate.largest();
  const double speed = element.strength.largest() * charts->mesh().size();
  const auto value = [&](const Vec3& p) { return evaluate(field, query.closest(p).point); };
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 here = value(places[i]);
    EXPECT_NEAR(here.dot(along[i]), speed, 0.05 * speed);
    EXPECT_NEAR(here.dot(left[i]), 0.0, 0.05 * speed);
    const double across =
        (value(places[i] + step * left[i]) - value(places[i] - step * left[i])).dot(left[i]) / (2.0 * step);
    EXPECT_NEAR(across, c, 0.12 * std::abs(c));
  }
}

TEST(Lines, FlowNearsOrLeavesACurveAtItsRate) {
  const auto charts = test::makeCharts(test::grid(40, 0.2));
  std::vector<Vec3> points, places, along, left;
  for (int i = 0; i <= 30; ++i) points.emplace_back(0.5 * std::cos(0.1 * i), 0.5 * std::sin(0.1 * i), 0.0);
  for (int i = 4; i < 27; i += 3) {
    places.push_back(points[i]);
    left.emplace_back(-std::cos(0.1 * i), -std::sin(0.1 * i), 0.0);
    along.emplace_back(-std::sin(0.1 * i), std::cos(0.1 * i), 0.0);
  }
  for (const ElementType type : {ElementType::Attachment, ElementType::Separation})
    checkRates(charts, line(type, points, 0.2, 3.0), places, along, left, 0.06);
}

TEST(Lines, TheyDoTheSameOnACurvedSurface) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(20));
  std::vector<Vec3> points, places, along, left;
  for (int i = 0; i <= 30; ++i) points.emplace_back(std::cos(0.05 * i), std::sin(0.05 * i), 0.0);
  for (int i = 4; i < 27; i += 3) {
    places.push_back(points[i]);
    left.emplace_back(0.0, 0.0, 1.0);
    along.emplace_back(-std::sin(0.05 * i), std::cos(0.05 * i), 0.0);
  }
  for (const ElementType type : {ElementType::Attachment, ElementType::Separation})
    checkRates(charts, line(type, points, 0.3, 3.0), places, along, left, 0.08);
}

}  // namespace
}  // namespace stormfield
