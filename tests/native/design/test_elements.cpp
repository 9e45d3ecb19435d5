#include "design/element_constraints.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "design/detail/curve_strip.h"
#include "field/interpolation.h"
#include "storm_checks.h"

namespace stormfield {
namespace {

using storms::singular;

/// The message of the InputError that the elements cause, empty when there is none.
std::string fault(const std::vector<DesignElement>& elements, Index samples = 5) {
  const auto charts = test::makeCharts(test::grid(10));
  ElementOptions options;
  options.samples = samples;
  try {
    elementConstraints(charts, elements, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

DesignElement source() {
  return singular("src", SingularKind::Source, {{0.1, 0.1, 0.0}}, {0.0, 1.0}, 0.3);
}

DesignElement curve(const std::string& name, ElementType type, std::vector<Vec3> points) {
  DesignElement element = source();
  element.name = name;
  element.type = type;
  element.points = std::move(points);
  return element;
}

template <typename Change>
DesignElement changed(DesignElement element, const Change& change) {
  change(element);
  return element;
}

TEST(Elements, BadInputNamesTheElementAndTheCure) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fault({source()}), "");
  EXPECT_EQ(fault({}), "the design has no element for this field: add one or enable one");
  EXPECT_EQ(fault({source(), source()}), "two elements are named \"src\": give each its own name");
  EXPECT_EQ(fault({changed(source(), [](auto& e) { e.radius = 0.0; })}),
            "singular element \"src\" has radius 0: give a number above 0");
  EXPECT_EQ(fault({changed(source(), [&](auto& e) { e.strength = nan; })}),
            "singular element \"src\" has strength nan: give a number above 0");
  EXPECT_EQ(fault({changed(source(), [&](auto& e) { e.points[0].x() = nan; })}),
            "singular element \"src\" point 0 is not finite: give three finite numbers");
  EXPECT_EQ(fault({changed(source(),
                           [](auto& e) {
                             e.lambdas = {0.2, 1.5};
                           })}),
            "singular element \"src\" has lambda 1.5, outside 0..1: move it into the range");
  EXPECT_EQ(fault({changed(source(),
                           [](auto& e) {
                             e.lambdas = {0.5, 0.2};
                           })}),
            "singular element \"src\" has lambda 0.2 at point 1 after 0.5: let lambda grow along it");
  EXPECT_EQ(fault({changed(source(),
                           [](auto& e) {
                             e.lambdas = {0.0, 0.5, 1.0};
                           })}),
            "singular element \"src\" has 3 lambda values for 1 points: give start and end, or one per point");
  EXPECT_EQ(fault({changed(source(),
                           [](auto& e) {
                             e.points.push_back({0.5, 0.5, 0.0}), e.lambdas = {0.4};
                           })}),
            "singular element \"src\" moves along 2 points at a single lambda: give a start and a later end");
  EXPECT_EQ(fault({curve("c", ElementType::Streamline, {{0, 0, 0}})}), "curve \"c\" has 1 points: it needs at least 2");
  EXPECT_EQ(fault({curve("r", ElementType::Regular, {{0, 0, 0}})}),
            "regular element \"r\" has no direction: add a second point or a direction");
  EXPECT_THROW(fromName<SingularKind>("whirl"), InputError);
  EXPECT_THROW(fromName<ElementType>("arrow"), InputError);
}

TEST(Elements, CurveOffTheSurfaceIsRefused) {
  EXPECT_EQ(fault({curve("X", ElementType::Streamline, {{0, 0, 0}, {0.2, 0, 0}, {0.4, 0, 0.4}})}),
            "curve \"X\" point 2 lies 0.4 off the surface, farther than its radius 0.3: move it onto the surface or "
            "enlarge the radius");
  EXPECT_EQ(fault({curve("X", ElementType::Streamline, {{0, 0, 0}, {0.2, 0, 0}, {0.4, 0, 0.2}})}), "");
}

TEST(Elements, ContradictionsNameBothElementsVertexAndLambda) {
  const DesignElement sink = singular("snk", SingularKind::Sink, {{0.15, 0.12, 0.0}}, {0.5, 1.0}, 0.3);
  EXPECT_EQ(fault({source(), sink}),
            "\"src\" (source) and \"snk\" (sink) contradict each other at vertex 72, lambda 0.5: move one away, or end "
            "both where a third path starts to merge them");
  const DesignElement east = curve("east", ElementType::Streamline, {{-0.5, 0, 0}, {0.5, 0, 0}});
  const DesignElement west = curve("west", ElementType::Streamline, {{0.5, 0, 0}, {-0.5, 0, 0}});
  EXPECT_NE(fault({east, west}).find("curve \"east\" and curve \"west\" contradict each other at vertex"),
            std::string::npos);
  // At different lambda, or one after the other, they may stand where they are.
  EXPECT_EQ(fault({changed(east,
                           [](auto& e) {
                             e.lambdas = {0.0, 0.4};
                           }),
                   changed(west,
                           [](auto& e) {
                             e.lambdas = {0.6, 1.0};
                           })}),
            "");
  EXPECT_EQ(fault({changed(source(), [](auto& e) { e.lambdas = {0.0, 0.5}; }), sink}), "");
}

TEST(Elements, StormsThatCannotBeJoinedAreRefused) {
  auto elements = storms::merge(SingularKind::VortexCcw, {-0.6, 0, 0}, {0.6, 0, 0}, {0, 0, 0}, {0, 0.5, 0}, 0.3);
  EXPECT_EQ(fault(elements), "");
  elements[1].kind = SingularKind::VortexCw;
  EXPECT_EQ(fault(elements), "\"a\" and \"b\" are joined but opposite: give both the same kind");
  elements[1].kind = SingularKind::Saddle;
  EXPECT_NE(fault(elements).find("the saddle \"b\" takes part"), std::string::npos);
  elements[1].kind = SingularKind::VortexCcw;
  elements.push_back(changed(elements[0], [](auto& e) {
    e.name = "c";
    e.points[0] = {0, -0.6, 0};
  }));
  EXPECT_NE(fault(elements).find("let two of them merge"), std::string::npos);
}

TEST(Elements, HardCoresAreExactAndTheRestSoft) {
  const auto charts = test::makeCharts(test::grid(20));
  const DesignElement hard = changed(source(), [](auto& e) { e.hard = true; });
  ElementOptions options;
  options.samples = 3;
  const ConstraintSet set = elementConstraints(charts, {hard}, options);
  std::size_t exact = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const double distance = (charts->mesh().point(set.vertex[i]) - hard.points[0]).norm();
    if (std::isinf(set.weight[i])) ++exact;
    if (distance < 0.09) {
      EXPECT_TRUE(std::isinf(set.weight[i]));
    }
    if (distance > 0.15) {
      EXPECT_FALSE(std::isinf(set.weight[i]));
    }
  }
  EXPECT_GT(exact, 3u);
  EXPECT_LT(exact, set.size() / 2);
}

TEST(Elements, StreamlineIsFollowed) {
  const auto charts = test::makeCharts(test::grid(40, 0.2));
  std::vector<Vec3> points;
  for (int i = 0; i <= 30; ++i) points.emplace_back(0.5 * std::cos(0.1 * i), 0.5 * std::sin(0.1 * i), 0.0);
  const DesignElement element = changed(curve("c", ElementType::Streamline, points), [](auto& e) { e.radius = 0.15; });
  const auto result = storms::solved(charts, {element}, 3);
  const ClosestPointQuery query(charts->meshPointer());
  const double speed = element.strength.largest() * charts->mesh().size();
  for (int i = 2; i < 28; ++i) {
    const Vec3 tangent(-std::sin(0.1 * i), std::cos(0.1 * i), 0.0);
    const Vec3 v = evaluate(sampleField(result.field, 1), query.closest(points[i]).point);
    EXPECT_GT(v.normalized().dot(tangent), 0.995);
    EXPECT_NEAR(v.norm(), speed, 0.05 * speed);
  }
}

TEST(Elements, StripDoesNotReachOtherSheets) {
  // A folded sheet: two squares 0.02 apart, connected along x = 1 only.
  const auto flat = test::makeCharts(test::grid(24));
  Points points = flat->mesh().points();
  for (Index v = 0; v < points.rows(); ++v)
    if (points(v, 0) > 0.001) points.row(v) << -points(v, 0) + 0.02, points(v, 1), 0.02;
  const auto charts = test::makeCharts({points, flat->mesh().triangles()});
  const ClosestPointQuery query(charts->meshPointer());
  const DesignElement element = curve("c", ElementType::Streamline, {{-0.7, -0.3, 0}, {-0.7, 0.3, 0}});
  const SurfacePath path(charts->mesh(), query, element);
  for (const StripEntry& entry : curveStrip(*charts, path, 0.2))
    EXPECT_LT(charts->mesh().point(entry.vertex).z(), 0.01);
}

TEST(Elements, ArrowIsCarriedAlongGeodesics) {
  const auto charts = test::makeCharts(test::grid(20, 0.2));
  const DesignElement arrow = curve("r", ElementType::Regular, {{0, 0, 0}, {0.1, 0.2, 0}});
  ElementOptions options;
  options.samples = 1;
  const ConstraintSet set = elementConstraints(charts, {arrow}, options);
  const Vec3 wanted = arrow.strength.largest() * charts->mesh().size() * Vec3(1, 2, 0).normalized();
  for (std::size_t i = 0; i < set.size(); ++i)
    EXPECT_LT((charts->toSpace(set.vertex[i], set.value[i]) - wanted).norm(), 0.03 * wanted.norm());
}

TEST(Elements, ParticleFollowsThePathlineInTime) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(20));
  std::vector<Vec3> points;
  for (int i = 0; i <= 40; ++i)
    points.push_back(Vec3(std::cos(0.04 * i), std::sin(0.04 * i), 0.3 * std::sin(0.1 * i)).normalized());
  DesignElement path = curve("p", ElementType::Pathline, points);
  path.lambdas = {0.1, 0.9};
  path.radius = 0.3;
  ElementOptions options;
  options.samples = 80;
  options.lambdaPerSecond = 0.25;
  SpaceTimeOptions solve;
  solve.samples = 80;
  Progress progress;
  const auto result = SpaceTimeSolver(charts, solve).solve(elementConstraints(charts, {path}, options), progress);
  const ClosestPointQuery query(charts->meshPointer());
  const SurfacePath wanted(charts->mesh(), query, path);
  Vec3 particle = points.front();
  const int steps = 800;
  double farthest = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double lambda = 0.1 + 0.8 * i / steps, dt = 0.8 / steps / options.lambdaPerSecond;
    const auto velocity = [&](double l, const Vec3& p) {
      return evaluate(at(result.field, l), query.closest(p).point);
    };
    const Vec3 half = particle + 0.5 * dt * velocity(lambda, particle);
    particle =
        position(charts->mesh(), query.closest(Vec3(particle + dt * velocity(lambda + 0.4 / steps, half))).point);
    farthest = std::max(farthest, (particle - wanted.positionAt(lambda + 0.8 / steps)).norm());
  }
  std::printf("farthest from the pathline: %.3f (edge %.3f, length %.2f)\n", farthest, charts->mesh().meanEdgeLength(),
              wanted.length());
  EXPECT_LT(farthest, charts->mesh().meanEdgeLength());
}

TEST(Elements, SameForAnyNumberOfThreads) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(8));
  const auto elements =
      storms::merge(SingularKind::VortexCcw, Vec3(1, -0.6, 0), Vec3(1, 0.6, 0), Vec3(1, 0, 0), Vec3(1, 0, 0.3), 0.5);
  ElementOptions options;
  options.samples = 20;
  const ConstraintSet many = elementConstraints(charts, elements, options);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ConstraintSet single = elementConstraints(charts, elements, options);
  EXPECT_EQ(many.vertex, single.vertex);
  EXPECT_EQ(many.sample, single.sample);
  EXPECT_EQ(many.value, single.value);
  EXPECT_EQ(many.weight, single.weight);
}

TEST(Elements, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  EXPECT_THROW(elementConstraints(test::makeCharts(test::grid(5)), {source()}, {}, &progress), Cancelled);
}

TEST(Elements, KeptLogMapsChangeNothing) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  const double r = charts->mesh().point(0).norm();
  const auto at = [&](double angle, double height) {
    const double across = std::sqrt(1.0 - height * height);
    return Vec3(r * across * std::cos(angle), r * across * std::sin(angle), r * height);
  };
  std::vector<DesignElement> elements =
      storms::merge(SingularKind::VortexCcw, at(-0.8, 0.0), at(0.8, 0.0), at(0.0, 0.3), at(0.0, 0.7), 0.3);
  elements.push_back(singular("still", SingularKind::Saddle, {at(3.0, 0.0)}, {0.0, 1.0}, 0.4));
  elements.push_back(singular("moving", SingularKind::Source, {at(2.0, -0.5), at(3.0, -0.6)}, {0.1, 0.9}, 0.3));
  ElementOptions options;
  LogMapCache kept;
  const auto check = [&] {
    const ConstraintSet anew = elementConstraints(charts, elements, options);
    const ConstraintSet set = elementConstraints(charts, elements, options, nullptr, &kept);
    EXPECT_EQ(set.vertex, anew.vertex);
    EXPECT_EQ(set.sample, anew.sample);
    EXPECT_EQ(set.value, anew.value);
    EXPECT_EQ(set.weight, anew.weight);
    EXPECT_EQ(set.element, anew.element);
  };
  options.samples = 12;
  check();
  check();
  elements[4].points[0] = at(2.1, -0.4);
  check();
  elements[0].points[0] = at(-0.7, 0.1);
  check();
  elements[3].radius = 0.35;
  check();
  elements.push_back(singular("in its way", SingularKind::Sink, {at(3.0, 0.0)}, {0.0, 1.0}, 0.4));
  EXPECT_THROW(elementConstraints(charts, elements, options, nullptr, &kept), InputError);
  elements.pop_back();
  check();
  options.samples = 7;
  check();
}

}  // namespace
}  // namespace stormfield
