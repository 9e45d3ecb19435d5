#include "edit/cancel.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <iostream>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "checks.h"
#include "data_sets.h"
#include "edit/entity_names.h"
#include "edited_fields.h"
#include "long_tests.h"
#include "whole_edits.h"

namespace stormfield::test {
namespace {

EditResult cancelled(const VectorField& field, const Topology& topology, const EntityRef& a, const EntityRef& b) {
  const FlatFaces faces(field.charts);
  return cancelPair(faces, field, topology, a, b);
}

void expectCancelled(const VectorField& field, const Topology& topology, const EntityRef& a, const EntityRef& b,
                     const ConleyIndex& index, const Contents& left) {
  const EditResult result = cancelled(field, topology, a, b);
  ASSERT_TRUE(result.applied) << result.reason;
  EXPECT_EQ(result.index, index);
  EXPECT_EQ(contentsOf(result.topology, result.left), left) << describe(contentsOf(result.topology, result.left));
  EXPECT_EQ(planCancel(field, topology, a, b).left, left);
  expectWhole(field, topology, a, b, result);
}

VectorField foldField(double sign) {
  return sampledOn(grid(40, 0.2),
                   [&](const Vec3& p) { return Vec3(sign * (0.1 - p.x() * p.x()), -sign * p.y(), 0.0); });
}

TEST(Cancel, NodeAndSaddleLeaveNothing) {
  for (const double sign : {1.0, -1.0}) {
    const VectorField field = foldField(sign);
    const Topology topology = topologyOf(field);
    ASSERT_EQ(topology.fixedPoints.size(), 2u);
    const EntityRef a{EntityKind::FixedPoint, 0}, b{EntityKind::FixedPoint, 1};
    expectCancelled(field, topology, a, b, {0, 0, 0}, {});
    expectCancelled(field, topology, b, a, {0, 0, 0}, {});
  }
}

TEST(Cancel, SinkInsideRepellingOrbitLeavesSource) {
  for (const double sign : {1.0, -1.0}) {
    const VectorField field =
        polarField(48, 1.6, [&](double r, double) { return Eigen::Vector2d(sign * r * (r * r - 1.0), sign); });
    const Topology topology = topologyOf(field);
    ASSERT_EQ(topology.fixedPoints.size(), 1u);
    ASSERT_EQ(topology.periodicOrbits.size(), 1u);
    Contents left;
    (sign > 0 ? left.sources : left.sinks) = 1;
    expectCancelled(field, topology, {EntityKind::FixedPoint, 0}, {EntityKind::PeriodicOrbit, 0},
                    sign > 0 ? ConleyIndex{0, 0, 1} : ConleyIndex{1, 0, 0}, left);
  }
}

TEST(Cancel, TwoOrbitsLeaveNothing) {
  const VectorField field =
      polarField(64, 2.6, [](double r, double) { return Eigen::Vector2d(r * (r - 1.0) * (r - 2.0), 1.0); });
  const Topology topology = topologyOf(field);
  ASSERT_EQ(topology.periodicOrbits.size(), 2u);
  expectCancelled(field, topology, {EntityKind::PeriodicOrbit, 0}, {EntityKind::PeriodicOrbit, 1}, {0, 0, 0}, {});
}

/// The Bogdanov-Takens normal form between its Hopf and its homoclinic bifurcation: a sink inside a repelling orbit, and
/// a saddle beside it. Past the homoclinic bifurcation the saddle stands alone beside the sink.
TEST(Cancel, OrbitAndSaddleLeaveSaddle) {
  for (const double sign : {1.0, -1.0}) {
    const VectorField field = sampledOn(scaled(grid(64, 0.2), 1.3), [&](const Vec3& p) {
      const double x = p.x(), y = p.y();
      return Vec3(sign * y, sign * (-0.25 + x * x + 0.4 * y + x * y), 0.0);
    });
    const Topology topology = topologyOf(field);
    const auto saddles = fixedPointsOf(topology, FixedPointKind::Saddle);
    ASSERT_EQ(saddles.size(), 1u);
    ASSERT_EQ(topology.periodicOrbits.size(), 1u);
    Contents left;
    left.saddles = 1;
    expectCancelled(field, topology, saddles[0], {EntityKind::PeriodicOrbit, 0}, {0, 1, 0}, left);
  }
}

/// Saddle-node on a circle: for a < 1 the circle would be an attracting orbit.
TEST(Cancel, DoublyConnectedSinkAndSaddleLeaveOrbit) {
  const VectorField field = polarField(
      64, 1.8, [](double r, double angle) { return Eigen::Vector2d(r * (1.0 - r * r), 1.0 - 1.3 * std::cos(angle)); });
  const Topology topology = topologyOf(field);
  const auto sinks = fixedPointsOf(topology, FixedPointKind::Sink);
  const auto saddles = fixedPointsOf(topology, FixedPointKind::Saddle);
  ASSERT_EQ(sinks.size(), 1u);
  ASSERT_EQ(saddles.size(), 1u);
  Contents left;
  left.attractingOrbits = 1;
  expectCancelled(field, topology, sinks[0], saddles[0], {1, 1, 0}, left);
}

struct Count {
  int applied = 0, noRoom = 0, unverified = 0;
};

/// Tries all pairs that may be cancelled; counts by case.
std::map<std::string, Count> tryAllPairs(const VectorField& field) {
  const FlatFaces faces(field.charts);
  const Topology topology = findTopology(faces, field);
  std::map<std::string, Count> counts;
  for (const auto& [a, b] : pairsOf(topology)) {
    std::string what;
    try {
      what = cancellationCase(topology, findInterval(topology, field.mesh(), a, b));
    } catch (const InputError&) {
      continue;  // no pair: several others lie in the way, say
    }
    const EditResult result = cancelPair(faces, field, topology, a, b);
    expectWhole(field, topology, a, b, result);
    Count& count = counts[what];
    ++(result.applied ? count.applied : result.reason.starts_with("around") ? count.noRoom : count.unverified);
  }
  return counts;
}

Count total(const std::map<std::string, Count>& counts) {
  Count sum;
  for (const auto& [what, count] : counts) {
    sum.applied += count.applied;
    sum.noRoom += count.noRoom;
    sum.unverified += count.unverified;
    std::cout << what << ": " << count.applied << " cancelled, " << count.noRoom << " without room, "
              << count.unverified << " not verified\n";
  }
  return sum;
}

/// All pairs of random fields on genus 0, 1 and 2: nothing wrong, and nearly all that have room are verified.
TEST(Cancel, FoundPairsOfRandomFields) {
  std::map<std::string, Count> counts;
  const auto add = [&](const VectorField& field) {
    for (const auto& [what, count] : tryAllPairs(field)) {
      counts[what].applied += count.applied;
      counts[what].noRoom += count.noRoom;
      counts[what].unverified += count.unverified;
    }
  };
  for (std::uint64_t seed = 1; seed <= shortOrLong<std::uint64_t>(1, 20); ++seed) {
    add(smoothField(icosphere(4), seed));
    add(smoothField(torus(48, 24), seed));
    add(smoothField(scaled(plateWithHoles(2, 6), 0.08), seed));
  }
  const Count sum = total(counts);
  EXPECT_GE(sum.applied, 19 * sum.unverified);
  EXPECT_GE(sum.applied, 9 * sum.noRoom);
  EXPECT_GE(sum.applied, 60);
}

TEST(Cancel, PairsOfGasEngine) {
  const auto engine = dataSet("gasEngineV.t");
  if (!engine) GTEST_SKIP() << withoutDataSet("gasEngineV.t");
  if (!longTests()) GTEST_SKIP() << "a long test";
  const Count sum = total(tryAllPairs(fieldOn(*engine)));
  EXPECT_GE(sum.applied, 115);
}

TEST(Cancel, SameForAnyNumberOfThreads) {
  const VectorField field = smoothField(icosphere(4), 3);
  const Topology topology = topologyOf(field);
  ASSERT_FALSE(topology.links.empty());
  const EntityLink& link = topology.links.front();
  const EditResult many = cancelled(field, topology, link.source, link.target);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const EditResult single = cancelled(field, topology, link.source, link.target);
  EXPECT_EQ(many.field.values, single.field.values);
  EXPECT_EQ(many.reason, single.reason);
}

TEST(Cancel, RefusesWhatIsNoPair) {
  const VectorField field = smoothField(torus(48, 24), 1);
  const Topology topology = topologyOf(field);
  const auto saddles = fixedPointsOf(topology, FixedPointKind::Saddle);
  const auto sinks = fixedPointsOf(topology, FixedPointKind::Sink);
  ASSERT_GE(saddles.size(), 2u);
  ASSERT_GE(sinks.size(), 2u);
  const auto reason = [&](const EntityRef& a, const EntityRef& b) {
    const EditResult result = cancelled(field, topology, a, b);
    EXPECT_FALSE(result.applied);
    EXPECT_EQ(result.field.values, field.values);
    return result.reason;
  };
  EXPECT_NE(reason(sinks[0], sinks[0]).find("was given twice"), std::string::npos);
  EXPECT_NE(reason(sinks[0], sinks[1]).find("both attract"), std::string::npos);
  EXPECT_NE(reason(saddles[0], saddles[1]).find("both saddles"), std::string::npos);
  EXPECT_NE(reason(sinks[0], {EntityKind::FixedPoint, 999}).find("there is no entity 999"), std::string::npos);
  EXPECT_NE(reason(sinks[0], {EntityKind::Boundary, 0}).find("there is no entity"), std::string::npos);
  for (const EntityRef& saddle : saddles) {
    bool linked = false;
    for (const EntityLink& link : topology.links) linked = linked || (link.source == saddle && link.target == sinks[0]);
    if (!linked) {
      EXPECT_NE(reason(saddle, sinks[0]).find("no flow leads from the saddle"), std::string::npos);
    }
  }
}

TEST(Cancel, NamesTheNearestPairWhereSeveralLieInTheWay) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const VectorField field = smoothField(torus(48, 24), seed);
    const Topology topology = topologyOf(field);
    for (const auto& [a, b] : pairsOf(topology)) {
      const EditResult result = cancelled(field, topology, a, b);
      if (result.reason.find("saddles lie between") == std::string::npos) continue;
      EXPECT_NE(result.reason.find("; cancel the "), std::string::npos) << result.reason;
      return;
    }
  }
  FAIL() << "no field has such a pair";
}

TEST(Cancel, RefusesCenters) {
  const VectorField field = sampledOn(icosphere(2), analytic::rotation({0.0, 0.0, 1.0}));
  const Topology topology = topologyOf(field);
  ASSERT_EQ(topology.fixedPoints.size(), 2u);
  const EditResult result = cancelled(field, topology, {EntityKind::FixedPoint, 0}, {EntityKind::FixedPoint, 1});
  EXPECT_NE(result.reason.find("neither attracts nor repels"), std::string::npos) << result.reason;
}

/// Source and sink of a sphere without a saddle: their block would be the sphere.
TEST(Cancel, RefusesTheLastTwo) {
  const VectorField field =
      sampledOn(icosphere(3), [](const Vec3& p) { return Vec3(-p.z() * p.x(), -p.z() * p.y(), 1.0 - p.z() * p.z()); });
  const Topology topology = topologyOf(field);
  ASSERT_EQ(topology.fixedPoints.size(), 2u);
  const EditResult result = cancelled(field, topology, {EntityKind::FixedPoint, 0}, {EntityKind::FixedPoint, 1});
  EXPECT_NE(result.reason.find("no room"), std::string::npos) << result.reason;
}

TEST(Cancel, RefusesWhereTheMeshIsTooCoarse) {
  const VectorField field = sampledOn(grid(3), [](const Vec3& p) { return Vec3(0.1 - p.x() * p.x(), -p.y(), 0.0); });
  const Topology topology = topologyOf(field);
  for (const auto& [a, b] : pairsOf(topology)) {
    expectWhole(field, topology, a, b, cancelled(field, topology, a, b));
  }
}

TEST(Cancel, StopsWhenCancelled) {
  const VectorField field = foldField(1.0);
  const Topology topology = topologyOf(field);
  const FlatFaces faces(field.charts);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(
      cancelPair(faces, field, topology, {EntityKind::FixedPoint, 0}, {EntityKind::FixedPoint, 1}, {}, &progress),
      Cancelled);
}

TEST(Contents, FewestOfEachIndex) {
  EXPECT_EQ(describe(fewestContents({0, 0, 0})), "nothing");
  EXPECT_EQ(describe(fewestContents({1, 0, 0})), "one sink");
  EXPECT_EQ(describe(fewestContents({0, 0, 1})), "one source");
  EXPECT_EQ(describe(fewestContents({0, 2, 0})), "2 saddles");
  EXPECT_EQ(describe(fewestContents({1, 1, 0})), "one attracting orbit");
  EXPECT_EQ(describe(fewestContents({0, 1, 1})), "one repelling orbit");
  EXPECT_EQ(describe(fewestContents({1, 2, 0})), "one attracting orbit and one saddle");
}

}  // namespace
}  // namespace stormfield::test
