// The transit map of one face against flows whose exits have closed forms, on the triangle (0, 0), (1, 0), (0, 1): sides
// 0 below, 1 along x + y = 1, 2 on the left.
#include "maps/detail/face_transit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "flat_fields.h"

namespace stormfield::test {
namespace {

constexpr double kAccuracy = 1e-5;  ///< of exits and jumps, as the header says

FaceTransit transitOf(const std::function<Vec3(const Vec3&)>& vectorAt) {
  const auto charts = makeCharts(surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  return {std::make_shared<const FlatFaces>(charts), std::make_shared<const VectorField>(flatField(charts, vectorAt))};
}

void expectArc(const BoundaryArc& arc, double begin, double length) {
  EXPECT_NEAR(arc.begin, begin, kAccuracy);
  EXPECT_NEAR(arc.length, length, 2.0 * kAccuracy);
}

void expectExit(ExitPosition exit, double wanted) {
  ASSERT_TRUE(exit.exists());
  EXPECT_NEAR(*exit, wanted, kAccuracy);
}

TEST(ExitPosition, IsAPositionOrNone) {
  EXPECT_FALSE(kNoExit.exists());
  EXPECT_TRUE(ExitPosition(0.0).exists());
  EXPECT_EQ(ExitPosition(1.5), ExitPosition(1.5));
  EXPECT_FALSE(ExitPosition(1.5) == kNoExit);
  EXPECT_EQ(*ExitPosition(2.25), 2.25);
  EXPECT_NEAR(arcLength(2.75, 0.5), 0.75, 1e-15);
  EXPECT_NEAR(arcLength(0.5, 2.75), 2.25, 1e-15);
}

TEST(FaceTransit, FollowsAConstantField) {
  const FaceTransit transit = transitOf([](const Vec3&) { return Vec3(1.0, 0.5, 0.0); });
  EXPECT_FALSE(transit.holdsFixedPoint(0));
  EXPECT_FALSE(transit.isCoarse(0));
  for (const double s : {0.1, 0.4, 0.9}) {
    expectExit(transit.exitOf(0, s), 1.0 + (1.0 - s) / 3.0);
    expectExit(transit.exitOf(0, 2.0 + s), 2.0 - 2.0 * s / 3.0);
    expectExit(transit.exitOf(0, 1.0 + (1.0 - s) / 3.0, Direction::Backward), s);
    EXPECT_FALSE(transit.touchesAt(0, s));
  }
  // It leaves over side 1 and enters over the two others.
  expectArc(transit.exitArcAt(0, 1.5), 1.0, 1.0);
  expectArc(transit.exitArcAt(0, 0.5), 1.0, 1.0);
  expectArc(transit.exitArcAt(0, 0.5, Direction::Backward), 2.0, 2.0);
  ASSERT_TRUE(transit.commonExitArc(0, 1.2, 1.9));
  expectArc(*transit.commonExitArc(0, 1.2, 1.9), 1.0, 1.0);
  EXPECT_FALSE(transit.commonExitArc(0, 1.2, kNoExit));
  EXPECT_TRUE(transit.isSameArc(0, kNoExit, kNoExit));
  EXPECT_FALSE(transit.isSameArc(0, 1.2, kNoExit));
  const auto arcs = transit.continuousArcs(0);
  ASSERT_EQ(arcs.size(), 1U);
  expectArc(arcs[0].entry, 2.0, 2.0);
  expectExit(arcs[0].exitOfBegin, 2.0);
  expectExit(arcs[0].exitOfEnd, 1.0);
}

TEST(FaceTransit, KeepsWhatASinkAttracts) {
  const auto towards = [](const Vec3& p) { return Vec3(0.25 - p.x(), 0.25 - p.y(), 0.0); };
  const FaceTransit sink = transitOf(towards), source = transitOf([&](const Vec3&p) { return Vec3(-towards(p)); });
  EXPECT_TRUE(sink.holdsFixedPoint(0));
  EXPECT_EQ(sink.poincare()[0], 1);
  for (const double s : {0.3, 1.6, 2.1}) EXPECT_FALSE(sink.exitOf(0, s).exists()) << s;
  const auto arcs = sink.continuousArcs(0);
  ASSERT_EQ(arcs.size(), 1U);
  expectArc(arcs[0].entry, 0.0, 3.0);
  EXPECT_EQ(arcs[0].exitOfBegin, kNoExit);
  EXPECT_EQ(sink.exitArcAt(0, 0.5).length, 0.0);
  EXPECT_TRUE(source.continuousArcs(0).empty());
  expectArc(source.exitArcAt(0, 0.5), 0.0, 3.0);
}

TEST(FaceTransit, JumpsWhereTrajectoriesComeToASaddle) {
  // The saddle is at (1/4, 1/4); trajectories with x = 1/4 come to it.
  const FaceTransit transit = transitOf([](const Vec3& p) { return Vec3(p.x() - 0.25, 0.25 - p.y(), 0.0); });
  EXPECT_EQ(transit.poincare()[0], -1);
  for (const double s : {0.05, 0.2}) expectExit(transit.exitOf(0, s), 3.0 - s);  // along a hyperbola to the left side
  for (const double s : {0.3, 0.6, 0.95}) {
    const double growth = (0.5 + std::sqrt(0.25 + s - 0.25)) / (2.0 * (s - 0.25));  // exp(t) at x + y = 1
    expectExit(transit.exitOf(0, s), 1.0 + 0.25 - 0.25 / growth);
  }
  const auto arcs = transit.continuousArcs(0);
  ASSERT_EQ(arcs.size(), 4U);
  expectArc(arcs[0].entry, 0.0, 0.25);
  expectArc(arcs[1].entry, 0.25, 0.75);
  expectArc(arcs[2].entry, 1.5, 0.25);
  expectArc(arcs[3].entry, 1.75, 0.25);
  EXPECT_FALSE(transit.touchesAt(0, 1.5));  // from outside
}

TEST(FaceTransit, JumpsWhereTrajectoriesTouchTheBorder) {
  // Trajectories y = h + (x - 1/2)^2 / 2 - 1/8 from (0, h): that of h = 1/8 touches side 0 at x = 1/2.
  const FaceTransit transit = transitOf([](const Vec3& p) { return Vec3(1.0, p.x() - 0.5, 0.0); });
  const EdgeFlow& below = transit.edgeFlow(transit.mesh().edge(0));
  ASSERT_EQ(transit.mesh().edgeHalfedge(transit.mesh().edge(0)), 0);
  EXPECT_EQ(below.sign, -1);
  EXPECT_NEAR(below.signChange, 0.5, 1e-12);
  EXPECT_TRUE(below.touchesInside);
  EXPECT_TRUE(transit.touchesAt(0, 0.5));
  for (const double h : {0.02, 0.1}) expectExit(transit.exitOf(0, 3.0 - h), 0.5 - std::sqrt(0.25 - 2.0 * h));
  for (const double h : {0.15, 0.5, 0.9}) {
    const double x = std::sqrt(0.25 + 2.0 * (1.0 - h)) - 0.5;  // of x + y = 1
    const double y = h + 0.5 * (x - 0.5) * (x - 0.5) - 0.125;
    EXPECT_NEAR(x + y, 1.0, 1e-12);
    expectExit(transit.exitOf(0, 3.0 - h), 1.0 + y);
  }
  const auto arcs = transit.continuousArcs(0);
  ASSERT_EQ(arcs.size(), 3U);
  expectArc(arcs[0].entry, 0.5, 0.5);
  expectArc(arcs[1].entry, 2.0, 0.875);
  expectArc(arcs[2].entry, 2.875, 0.125);
}

TEST(FaceTransit, WidensArcsByTheAngleOfTheFlow) {
  const FaceTransit transit = transitOf([](const Vec3&) { return Vec3(1.0, 0.5, 0.0); });
  const double slack = FaceTransit::kSlack * std::hypot(1.0, 0.5) / (1.5 / std::sqrt(2.0));  // over the sine
  const BoundaryArc wide = transit.widened(0, {1.4, 0.2});
  EXPECT_NEAR(wide.begin, 1.4 - slack, 1e-12);
  EXPECT_NEAR(wide.length, 0.2 + 2.0 * slack, 1e-12);
}

}  // namespace
}  // namespace stormfield::test
