// Brush strokes: what they change and what they leave, against their formulas.
#include "design/brush.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "design/design_solve.h"
#include "storm_checks.h"

namespace stormfield {
namespace {

DesignElement brush(BrushMode mode, double falloff = 0.5) {
  DesignElement element;
  element.name = "comb";
  element.type = ElementType::Brush;
  element.mode = mode;
  element.falloff = falloff;
  element.radius = 0.2;
  element.points = {{-0.4, 0.05, 0}, {0.0, 0.15, 0}, {0.5, 0.1, 0}};
  return element;
}

ParameterizedField random(const test::ChartsPointer& charts, Index samples) {
  std::vector<Complex> values;
  for (Index j = 0; j < samples; ++j) {
    const VectorField field = test::randomField(charts, 10 + static_cast<std::uint64_t>(j));
    values.insert(values.end(), field.values.begin(), field.values.end());
  }
  FieldValues stored(values.size());
  std::copy(values.begin(), values.end(), stored.data());
  return makeParameterizedField(charts, evenLambdas(samples), std::move(stored));
}

double distanceTo(const DesignElement& element, const Vec3& p) {
  double least = 1e9;
  for (std::size_t k = 0; k + 1 < element.points.size(); ++k) {
    const Vec3 along = element.points[k + 1] - element.points[k];
    const double t = std::clamp((p - element.points[k]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (element.points[k] + t * along - p).norm());
  }
  return least;
}

constexpr BrushMode kModes[] = {BrushMode::Replace, BrushMode::Add, BrushMode::Strength, BrushMode::Smooth};

TEST(Brush, ChangesNothingOutsideItsFalloffAndItsLambda) {
  const auto charts = test::makeCharts(test::grid(30, 0.2));
  for (const BrushMode mode : kModes)
    for (const double falloff : {0.0, 0.5, 1.0}) {
      DesignElement element = brush(mode, falloff);
      element.lambdas = {0.3, 0.6};
      const ParameterizedField before = random(charts, 21);
      ParameterizedField after = before;
      applyBrushes(after, {element});
      std::size_t changed = 0;
      for (Index j = 0; j < 21; ++j)
        for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
          const bool outside = distanceTo(element, charts->mesh().point(v)) > 0.2 + 1e-9 || before.lambdas[j] < 0.24 ||
                               before.lambdas[j] > 0.66;
          if (outside) {
            EXPECT_EQ(after.sample(j)[v], before.sample(j)[v]);
          }
          changed += after.sample(j)[v] != before.sample(j)[v];
        }
      EXPECT_GT(changed, 100u);
    }
}

TEST(Brush, WithAHardEdgeItIsTheStroke) {
  const auto charts = test::makeCharts(test::grid(30, 0.2));
  const DesignElement element = brush(BrushMode::Replace, 0.0);
  ParameterizedField field = random(charts, 1);
  applyBrushes(field, {element});
  const double speed = element.strength.largest() * charts->mesh().size();
  int inside = 0;
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const Vec3 p = charts->mesh().point(v);
    if (distanceTo(element, p) > 0.19 || p.x() < -0.3 || p.x() > 0.4 || std::abs(p.x()) < 0.15) continue;
    const Vec3 along =
        (p.x() < 0.0 ? element.points[1] - element.points[0] : element.points[2] - element.points[1]).normalized();
    EXPECT_GT(charts->toSpace(v, field.sample(0)[v]).dot(along), std::cos(5.0 * test::kPi / 180.0) * speed);
    ++inside;
  }
  EXPECT_GT(inside, 30);
}

TEST(Brush, ModesAreTheirFormulas) {
  const auto charts = test::makeCharts(test::grid(30));
  const ParameterizedField before = random(charts, 1);
  const auto with = [&](BrushMode mode, const std::vector<Vec3>& points, double falloff) {
    DesignElement element = brush(mode, falloff);
    element.points = points;
    ParameterizedField field = before;
    applyBrushes(field, {element});
    return field;
  };
  const std::vector<Vec3> there = {{-0.5, 0, 0}, {0.5, 0, 0}}, back = {{0.5, 0, 0}, {-0.5, 0, 0}};
  const double speed = DesignElement().strength.largest() * charts->mesh().size();
  const auto added = with(BrushMode::Add, there, 1.0), taken = with(BrushMode::Add, back, 1.0);
  const auto faster = with(BrushMode::Strength, there, 0.0), replaced = with(BrushMode::Replace, there, 1.0);
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const Vec3 p = charts->mesh().point(v);
    const Complex old = before.sample(0)[v];
    if (std::abs(p.x()) > 0.45 || std::abs(p.y()) >= 0.2) continue;
    const double t = std::abs(p.y()) / 0.2, w = 1.0 - t * t * (3.0 - 2.0 * t);
    const Complex along = charts->toTangent(v, Vec3::UnitX());
    EXPECT_LT(std::abs(added.sample(0)[v] - (old + w * speed * along)), 1e-12);
    // The reversed stroke is the negated target.
    EXPECT_LT(std::abs(taken.sample(0)[v] - (old - w * speed * along)), 1e-12);
    EXPECT_LT(std::abs(replaced.sample(0)[v] - (old + w * (speed * along - old))), 1e-12);
    EXPECT_NEAR(std::abs(faster.sample(0)[v]), speed, 1e-12);
    EXPECT_NEAR(std::arg(faster.sample(0)[v] / old), 0.0, 1e-12);
  }
}

TEST(Brush, SmoothIsHarmonicInsideAHardEdge) {
  const auto charts = test::makeCharts(test::grid(30));
  const DesignElement element = brush(BrushMode::Smooth, 0.0);
  ParameterizedField field = random(charts, 1);
  applyBrushes(field, {element});
  // In the flat grid the weights are those of the five-point stencil, so each value is the mean of four neighbours.
  const Index row = 31;
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    if (distanceTo(element, charts->mesh().point(v)) > 0.199) continue;
    const auto at = [&](Index w) { return charts->toSpace(w, field.sample(0)[w]); };
    EXPECT_LT((4.0 * at(v) - at(v - 1) - at(v + 1) - at(v - row) - at(v + row)).norm(), 1e-10);
  }
}

TEST(Brush, TheSamplingOfAStrokeDoesNotMatter) {
  const auto charts = test::makeCharts(test::grid(30, 0.2));
  DesignElement few = brush(BrushMode::Replace), many = few;
  few.points.clear(), many.points.clear();
  const auto at = [](double t) { return Vec3(0.6 * std::cos(t), 0.6 * std::sin(t), 0.0); };
  for (int i = 0; i <= 18; ++i) few.points.push_back(at(3.0 * i / 18));
  for (int i = 0; i <= 300; ++i) many.points.push_back(at(3.0 * i / 300));
  ParameterizedField a = random(charts, 1), b = a;
  applyBrushes(a, {few}), applyBrushes(b, {many});
  const double speed = few.strength.largest() * charts->mesh().size();
  double worst = 0.0;
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v)
    worst = std::max(worst, std::abs(a.sample(0)[v] - b.sample(0)[v]) / speed);
  EXPECT_LT(worst, 0.2);
}

TEST(Brush, ActsAfterTheSolveInTheOrderOfTheList) {
  const auto charts = test::makeCharts(test::grid(20, 0.2));
  DesignElement source = storms::singular("s", SingularKind::Source, {{0, 0, 0}}, {0.0, 1.0}, 0.3);
  DesignElement first = brush(BrushMode::Replace, 0.0), second = first;
  second.name = "second";
  std::reverse(second.points.begin(), second.points.end());
  DesignOptions options;
  options.samples = 3;
  options.evenSpeed = 0.5;
  Progress progress;
  const auto solve = [&](const std::vector<DesignElement>& elements) {
    return DesignSolver(charts, options).solve(elements, progress).field;
  };
  const ParameterizedField plain = solve({source}), twice = solve({first, source, second});
  const ParameterizedField last = solve({source, second});
  for (std::size_t i = 0; i < plain.values.size(); ++i) EXPECT_EQ(twice.values[i], last.values[i]);
  std::size_t same = 0;
  for (std::size_t i = 0; i < plain.values.size(); ++i) same += plain.values[i] == last.values[i];
  EXPECT_GT(same, plain.values.size() / 2);
  EXPECT_LT(same, plain.values.size());
}

TEST(Brush, AnyNumberOfThreadsGivesTheSame) {
  const auto charts = test::makeCharts(test::grid(20, 0.2));
  const ParameterizedField before = random(charts, 9);
  const std::vector<DesignElement> elements = {brush(BrushMode::Smooth), brush(BrushMode::Add)};
  ParameterizedField many = before, one = before;
  applyBrushes(many, elements);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  applyBrushes(one, elements);
  for (std::size_t i = 0; i < one.values.size(); ++i) EXPECT_EQ(one.values[i], many.values[i]);
}

TEST(Brush, BadStrokesAreRefused) {
  const auto charts = test::makeCharts(test::grid(10));
  const auto fault = [&](const DesignElement& element) -> std::string {
    ParameterizedField field = random(charts, 2);
    try {
      checkElements({element});
      applyBrushes(field, {element});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto changed = [](BrushMode mode, const auto& change) {
    DesignElement element = brush(mode);
    change(element);
    return element;
  };
  EXPECT_EQ(fault(changed(BrushMode::Add, [](auto& e) { e.falloff = 1.5; })),
            "brush \"comb\" has falloff 1.5: give 0 to 1");
  EXPECT_NE(fault(changed(BrushMode::Add,
                          [](auto& e) {
                            for (Vec3& p : e.points) p.z() = 3.0;
                          }))
                .find("brush \"comb\" point 0 lies 3 off the surface"),
            std::string::npos);
  EXPECT_EQ(fault(changed(BrushMode::Add,
                          [](auto& e) {
                            e.radius = 0.01, e.points = {{-0.15, 0.07, 0}, {-0.05, 0.13, 0}};
                          })),
            "brush \"comb\" covers no vertex of the mesh: make its radius larger, or refine the mesh");
  EXPECT_NE(fault(changed(BrushMode::Smooth, [](auto& e) { e.radius = 4.0; })).find("smooth a whole part"),
            std::string::npos);
  try {
    elementConstraints(charts, {brush(BrushMode::Add)}, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "the design has only brush strokes for this field: add an element that they change");
  }
}

}  // namespace
}  // namespace stormfield
