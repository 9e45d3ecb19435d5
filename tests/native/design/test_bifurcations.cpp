// A bifurcation element: the tracking finds the one event that was asked for, where and when it was (thesis 11.1.4).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "storm_checks.h"
#include "topology/topology.h"
#include "tracking/tracking.h"

namespace stormfield {
namespace {

constexpr double kLambda = 0.43, kReach = 0.25;

DesignElement bifurcation(BifurcationEvent event, const Vec3& place, const Vec3& axis, double radius) {
  DesignElement element;
  element.name = "b";
  element.type = ElementType::Bifurcation;
  element.event = event;
  element.points = {place};
  element.lambdas = {kLambda};
  element.direction = axis;
  element.radius = radius;
  element.reach = kReach;
  return element;
}

struct Case {
  const char* name;
  test::ChartsPointer charts;
  Vec3 place, axis;
  double radius;
};

std::vector<Case> cases() {
  const Vec3 onSphere = Vec3(0.8, 0.5, 0.3).normalized();
  return {{"square", test::makeCharts(test::grid(40, 0.15)), {0.113, -0.071, 0}, Vec3(1, 0.4, 0), 0.6},
          {"sphere", test::makeCharts(test::dividedIcosahedron(32)), onSphere, Vec3(0, 0, 1), 0.45},
          {"torus", test::makeCharts(test::torus(196, 60, 1.0, 0.4, 0.1, 3)), {1.4, 0, 0}, Vec3(0, 1, 0.3), 0.45}};
}

Tracking tracked(const SpaceTimeResult& result) {
  Progress progress;
  return trackFixedPoints(result.field, {}, progress);
}

/// Events within a radius of the place and within the reach of lambda.
std::vector<Bifurcation> eventsNear(const Tracking& tracking, const DesignElement& element) {
  std::vector<Bifurcation> near;
  for (const Bifurcation& b : tracking.bifurcations)
    if ((b.position - element.points[0]).norm() < element.radius.largest() && std::abs(b.lambda - kLambda) < kReach)
      near.push_back(b);
  return near;
}

void checkIndexSum(const SpaceTimeResult& result) {
  const TriangleMesh& mesh = result.field.charts->mesh();
  if (mesh.boundaryLoopCount() > 0) return;
  for (Index j = 0; j < result.field.sampleCount(); ++j) {
    int sum = 0;
    for (const FixedPoint& p : findFixedPoints(sampleField(result.field, j))) sum += p.index;
    EXPECT_EQ(sum, mesh.eulerCharacteristic()) << j;
  }
}

const PathSample* atLambda(const TrackedPath& path, double lambda) {
  for (const PathSample& s : path.samples)
    if (std::abs(s.lambda - lambda) < 1e-9) return &s;
  return nullptr;
}

/// The square of the pair's distance over lambda, fitted by a line through the event: its worst difference from the
/// line, over its largest value.
double bending(const SpaceTimeResult& result, const Tracking& tracking, const Bifurcation& event, bool after) {
  std::vector<std::pair<double, double>> squares;
  for (const double lambda : result.field.lambdas) {
    const double past = after ? lambda - event.lambda : event.lambda - lambda;
    if (past < 0.0 || past > 0.9 * kReach) continue;
    const PathSample* node = atLambda(tracking.paths[event.paths[0]], lambda);
    const PathSample* saddle = atLambda(tracking.paths[event.paths[1]], lambda);
    if (node && saddle) squares.emplace_back(past, (node->position - saddle->position).squaredNorm());
  }
  EXPECT_GT(squares.size(), 5u);
  double xy = 0.0, xx = 0.0, largest = 0.0, worst = 0.0;
  for (const auto& [x, y] : squares) xy += x * y, xx += x * x, largest = std::max(largest, y);
  for (const auto& [x, y] : squares) worst = std::max(worst, std::abs(y - xy / xx * x));
  return worst / largest;
}

TEST(Bifurcations, APairAppearsOrVanishes) {
  for (const Case& c : cases())
    for (const BifurcationEvent event : {BifurcationEvent::AppearSink, BifurcationEvent::AppearSource,
                                         BifurcationEvent::VanishSink, BifurcationEvent::VanishSource}) {
      SCOPED_TRACE(std::string(c.name) + " " + name(event));
      const bool after = event == BifurcationEvent::AppearSink || event == BifurcationEvent::AppearSource;
      const bool source = event == BifurcationEvent::AppearSource || event == BifurcationEvent::VanishSource;
      const DesignElement element = bifurcation(event, c.place, c.axis, c.radius);
      const auto result = storms::solved(c.charts, {element}, 61);
      checkIndexSum(result);
      const Tracking tracking = tracked(result);
      const std::vector<Bifurcation> near = eventsNear(tracking, element);
      ASSERT_EQ(near.size(), 1u);
      EXPECT_EQ(near[0].kind, after ? BifurcationKind::Creation : BifurcationKind::Annihilation);
      EXPECT_EQ(near[0].node, source ? FixedPointKind::Source : FixedPointKind::Sink);
      EXPECT_LT((near[0].position - c.place).norm(), 0.5 * c.charts->mesh().meanEdgeLength());
      EXPECT_LT(std::abs(near[0].lambda - kLambda), 0.5 / 60);
      EXPECT_LT(bending(result, tracking, near[0], after), 0.02);
    }
}

TEST(Bifurcations, APointChangesItsStabilityAndShedsAnOrbit) {
  for (const Case& c : cases())
    for (const BifurcationEvent event : {BifurcationEvent::HopfBirth, BifurcationEvent::HopfDeath})
      for (const bool reverse : {false, true}) {
        SCOPED_TRACE(std::string(c.name) + " " + name(event));
        const bool birth = event == BifurcationEvent::HopfBirth;
        DesignElement element = bifurcation(event, c.place, c.axis, c.radius);
        element.reverse = reverse;
        const auto result = storms::solved(c.charts, {element}, 61);
        checkIndexSum(result);
        const std::vector<Bifurcation> near = eventsNear(tracked(result), element);
        ASSERT_EQ(near.size(), 1u);
        EXPECT_EQ(near[0].kind, BifurcationKind::Hopf);
        EXPECT_EQ(near[0].node, birth ? FixedPointKind::Source : FixedPointKind::Sink);
        EXPECT_LT((near[0].position - c.place).norm(), 0.5 * c.charts->mesh().meanEdgeLength());
        EXPECT_LT(std::abs(near[0].lambda - kLambda), 0.5 / 60);
        const FlatFaces faces(c.charts);
        for (const Index j : {0, 60}) {
          const Topology topology = findTopology(faces, sampleField(result.field, j));
          int orbits = 0;
          for (const PeriodicOrbit& orbit : topology.periodicOrbits)
            if ((position(c.charts->mesh(), orbit.points[0]) - c.place).norm() < 0.7 * c.radius) {
              ++orbits;
              EXPECT_EQ(orbit.kind, OrbitKind::Attracting);
              EXPECT_NEAR(orbit.length, test::kPi * c.radius, 0.1 * test::kPi * c.radius);
            }
          EXPECT_EQ(orbits, (j == 60) == birth ? 1 : 0) << j;
        }
      }
}

TEST(Bifurcations, BadOnesAreRefused) {
  const auto charts = test::makeCharts(test::grid(20));
  const auto fault = [&](const std::vector<DesignElement>& elements) -> std::string {
    ElementOptions options;
    options.samples = 21;
    try {
      elementConstraints(charts, elements, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto changed = [](const auto& change) {
    DesignElement element = bifurcation(BifurcationEvent::AppearSink, {0.1, 0.1, 0}, {1, 0, 0}, 0.5);
    change(element);
    return element;
  };
  const DesignElement good = changed([](auto&) {});
  EXPECT_EQ(fault({good}), "");
  EXPECT_EQ(fault({changed([](auto& e) { e.lambdas = {1.0}; })}),
            "bifurcation \"b\" is at lambda 1, the end of the range: move it inside, so that there is a before and an "
            "after");
  EXPECT_EQ(fault({changed([](auto& e) { e.lambdas = {0.02}; })}),
            "bifurcation \"b\" is at lambda 0.02, less than one sample from the end of the range: move it inside, or "
            "solve more samples");
  EXPECT_NE(fault({changed([](auto& e) {
              e.points = {{0.8, 0, 0}};
            })}).find("reaches the border of the surface"),
            std::string::npos);
  EXPECT_NE(fault({changed([](auto& e) { e.radius = 0.1; })}).find("cannot hold two points apart"), std::string::npos);
  EXPECT_NE(fault({changed([](auto& e) { e.reach = 0.0; })}).find("has reach 0: give a length"), std::string::npos);
  EXPECT_NE(fault({changed([](auto& e) { e.reach = 0.05; })}).find("less than two samples"), std::string::npos);
  EXPECT_NE(fault({changed([](auto& e) {
              e.points.push_back({0, 0, 0});
            })}).find("one point and one lambda"),
            std::string::npos);
  const DesignElement other = changed([](auto& e) { e.name = "c", e.points[0].x() += 0.2; });
  EXPECT_EQ(fault({good, other}),
            "bifurcation \"b\" and bifurcation \"c\" lie at one place: move one away, or let them act at different "
            "lambda");
  EXPECT_NE(fault({good, storms::singular("s", SingularKind::Source, {{0.1, 0.2, 0}}, {0.0, 1.0}, 0.2)})
                .find("singular element \"s\" lie at one place"),
            std::string::npos);
}

}  // namespace
}  // namespace stormfield
