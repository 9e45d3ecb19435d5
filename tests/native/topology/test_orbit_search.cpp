#include "topology/detail/orbit_search.h"

#include <gtest/gtest.h>

#include "base/message.h"
#include "checks.h"
#include "cylinder_flow.h"
#include "flows.h"

namespace stormfield::test {
namespace {

struct Given {
  explicit Given(const CylinderFlow& flow)
      : field(flow.field()), faces(field.charts), componentOf(field.mesh().faceCount(), 0) {}

  OrbitSearch::Outcome from(const CylinderFlow& flow, double z, Direction direction) const {
    const auto [h, fraction] = flow.crossedAt(field.mesh(), z);
    const OrbitSearch search(faces, field, componentOf, {});
    return search.findFrom(
        {.halfedge = h, .fraction = fraction, .crossings = 2 * flow.around, .direction = direction, .component = 0},
        [](const FoundOrbit&) { return false; });
  }

  VectorField field;
  FlatFaces faces;
  std::vector<Index> componentOf;
};

TEST(OrbitSearch, FindsTheOrbitOfACylinderFlowWithItsMultiplier) {
  for (const double speed : {1.0, -0.7}) {
    for (const double rate : {0.2, 0.05, -0.1}) {
      const CylinderFlow flow{.speed = speed, .rate = rate};
      const Given given(flow);
      const Direction direction = rate > 0.0 ? Direction::Forward : Direction::Backward;
      for (const double away : {-0.05, 0.04}) {
        const std::string what = message("speed ", speed, ", rate ", rate, ", ", away, " away");
        const auto outcome = given.from(flow, flow.height + away, direction);
        ASSERT_TRUE(outcome.orbit) << what;
        const FoundOrbit& found = *outcome.orbit;
        for (const SurfacePoint& p : found.orbit.points) {
          EXPECT_NEAR(position(given.field.mesh(), p).z(), flow.height, 1e-7) << what;
        }
        EXPECT_NEAR(found.orbit.period, flow.period(), 1e-6) << what;
        EXPECT_NEAR(found.orbit.length, flow.perimeter(), 1e-6) << what;
        EXPECT_NEAR(found.orbit.multiplier, flow.multiplier(), 1e-5 * flow.multiplier()) << what;
        EXPECT_EQ(found.orbit.kind, rate > 0.0 ? OrbitKind::Attracting : OrbitKind::Repelling) << what;
        for (const OrbitSide side : kOrbitSides) {
          EXPECT_EQ(found.sides[side], rate > 0.0 ? SideFlow::Attracted : SideFlow::Repelled) << what;
        }
        // Left of the flow is up where it goes counter-clockwise.
        EXPECT_EQ(found.foundSide, (away > 0.0) == (speed > 0.0) ? OrbitSide::Left : OrbitSide::Right) << what;
        EXPECT_EQ(found.loops, 1) << what;
        EXPECT_FALSE(found.inBand) << what;
      }
    }
  }
}

TEST(OrbitSearch, FindsABandOfClosedStreamlines) {
  const CylinderFlow flow{.rate = 0.0};
  const Given given(flow);
  const auto outcome = given.from(flow, 0.03, Direction::Forward);
  ASSERT_TRUE(outcome.orbit);
  EXPECT_EQ(outcome.orbit->orbit.kind, OrbitKind::Center);
  for (const OrbitSide side : kOrbitSides) EXPECT_EQ(outcome.orbit->sides[side], SideFlow::Closed);
  EXPECT_NEAR(outcome.orbit->orbit.multiplier, 1.0, 1e-12);
  const auto [h, fraction] = flow.crossedAt(given.field.mesh(), 0.03);
  const OrbitSearch search(given.faces, given.field, given.componentOf, {});
  const auto faces = search.facesIfClosed(h, fraction, 0, 100, 1e-6);
  ASSERT_TRUE(faces);
  for (const Index f : *faces) {
    EXPECT_LT(std::abs(position(given.field.mesh(), {f, Eigen::Vector3d::Constant(1.0 / 3.0)}).z() - 0.03), 0.15);
  }
}

TEST(OrbitSearch, FindsNoOrbitWhereStreamlinesPass) {
  // A spiral up the whole cylinder: z' is the same everywhere.
  const CylinderFlow flow{.rate = 1e-9, .height = 3e7};
  const Given given(flow);
  const auto [h, fraction] = flow.crossedAt(given.field.mesh(), 0.03);
  const OrbitSearch search(given.faces, given.field, given.componentOf, {});
  EXPECT_FALSE(search.facesIfClosed(h, fraction, 0, 100, 1e-3));
  EXPECT_FALSE(given.from(flow, 0.03, Direction::Forward).orbit);
}

TEST(OrbitSearch, DoesNotExamineAKnownOrbitAgain) {
  const CylinderFlow flow;
  const Given given(flow);
  const auto [h, fraction] = flow.crossedAt(given.field.mesh(), 0.06);
  const OrbitSearch search(given.faces, given.field, given.componentOf, {});
  const auto outcome = search.findFrom({.halfedge = h, .fraction = fraction, .crossings = 50, .component = 0},
                                       [](const FoundOrbit& found) { return !found.passages.empty(); });
  ASSERT_TRUE(outcome.orbit);
  EXPECT_TRUE(outcome.orbit->known);
  EXPECT_EQ(outcome.orbit->sides.left, SideFlow::Unknown);
}

}  // namespace
}  // namespace stormfield::test
