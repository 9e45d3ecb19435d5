// What cannot be edited, or only just: each is refused in a sentence and changes nothing, or it is whole.
#include <gtest/gtest.h>

#include <limits>

#include "checks.h"
#include "edit/cancel.h"
#include "edit/move.h"
#include "mesh/closest_point.h"
#include "whole_edits.h"

namespace stormfield::test {
namespace {

void expectRefused(const VectorField& field, const EditResult& result, const std::string& why) {
  EXPECT_FALSE(result.applied);
  EXPECT_NE(result.reason.find(why), std::string::npos) << result.reason;
  EXPECT_EQ(result.field.values, field.values);
}

/// Every linked pair is cancelled whole, or refused with a reason.
void expectWholePairs(const VectorField& field) {
  const FlatFaces faces(field.charts);
  const Topology topology = findTopology(faces, field);
  ASSERT_FALSE(topology.fixedPoints.empty());
  for (const auto& [a, b] : pairsOf(topology)) {
    expectWhole(field, topology, a, b, cancelPair(faces, field, topology, a, b));
  }
}

Vec3 fold(const Vec3& p) {
  return {0.1 - p.x() * p.x(), -p.y(), 0.0};
}

TEST(BadInput, PairsOnDifferentComponents) {
  const VectorField field = smoothField(joined(icosphere(3), icosphere(3), {4, 0, 0}), 1);
  const FlatFaces faces(field.charts);
  const Topology topology = findTopology(faces, field);
  const auto saddles = fixedPointsOf(topology, FixedPointKind::Saddle);
  const auto sinks = fixedPointsOf(topology, FixedPointKind::Sink);
  ASSERT_FALSE(saddles.empty());
  int apart = 0;
  for (const EntityRef& saddle : saddles) {
    for (const EntityRef& sink : sinks) {
      const double x = topology.fixedPoints[saddle.index].position.x(),
                   y = topology.fixedPoints[sink.index].position.x();
      if ((x > 2.0) == (y > 2.0)) continue;
      ++apart;
      expectRefused(field, cancelPair(faces, field, topology, saddle, sink), "no flow leads");
    }
  }
  EXPECT_GT(apart, 0);
}

TEST(BadInput, VectorsThatAreNotFinite) {
  const VectorField field = sampledOn(grid(24, 0.2), fold);
  const FlatFaces faces(field.charts);
  const Topology topology = findTopology(faces, field);
  ASSERT_EQ(topology.fixedPoints.size(), 2u);
  VectorField broken = field;
  broken.values[11] = Complex(std::numeric_limits<double>::quiet_NaN(), 0.0);
  const EditResult result =
      cancelPair(faces, broken, topology, {EntityKind::FixedPoint, 0}, {EntityKind::FixedPoint, 1});
  EXPECT_FALSE(result.applied);
  EXPECT_NE(result.reason.find("the vector of vertex 11 is not finite"), std::string::npos) << result.reason;
  const EditResult moved = movePoint(faces, broken, topology, 0, topology.fixedPoints[1].point);
  EXPECT_NE(moved.reason.find("the vector of vertex 11 is not finite"), std::string::npos) << moved.reason;
}

TEST(BadInput, FieldsThatVanishOnTheBorderOfTheBlock) {
  expectWholePairs(
      sampledOn(grid(40, 0.2), [](const Vec3& p) { return Vec3(p.head<2>().norm() < 0.55 ? fold(p) : Vec3::Zero()); }));
}

TEST(BadInput, PairsAtTheBoundaryOfTheSurface) {
  for (const double shift : {0.6, 0.65, 0.68}) {
    expectWholePairs(sampledOn(grid(40, 0.2), [&](const Vec3& p) { return fold(p - Vec3(shift, 0.0, 0.0)); }));
    expectWholePairs(sampledOn(grid(40, 0.2), [&](const Vec3& p) { return fold(p - Vec3(0.0, 1.4 * shift, 0.0)); }));
  }
}

/// A saddle connection is no pair, and ends nowhere that the analysis could hold fast.
TEST(BadInput, SaddlesThatAreConnected) {
  const VectorField field =
      sampledOn(grid(40), [](const Vec3& p) { return Vec3(0.25 - p.x() * p.x(), 2.0 * p.x() * p.y(), 0.0); });
  const FlatFaces faces(field.charts);
  const Topology topology = findTopology(faces, field);
  const auto saddles = fixedPointsOf(topology, FixedPointKind::Saddle);
  ASSERT_EQ(saddles.size(), 2u);
  expectRefused(field, cancelPair(faces, field, topology, saddles[0], saddles[1]), "are both saddles");
  expectWholePairs(field);
}

/// So weak that the search for orbits hardly sees it turn.
TEST(BadInput, WeakSpirals) {
  for (const double growth : {1e-3, 1e-5}) {
    const VectorField field =
        polarField(48, 1.6, [&](double r, double) { return Eigen::Vector2d(growth * r * (r * r - 1.0), 1.0); });
    const FlatFaces faces(field.charts);
    const Topology topology = findTopology(faces, field);
    for (std::size_t i = 0; i < topology.periodicOrbits.size(); ++i) {
      const EntityRef point{EntityKind::FixedPoint, 0}, orbit{EntityKind::PeriodicOrbit, static_cast<Index>(i)};
      const EditResult result = cancelPair(faces, field, topology, point, orbit);
      if (result.applied) {
        expectWhole(field, topology, point, orbit, result);
      } else {
        expectRefused(field, result, " ");
      }
    }
  }
}

/// Between the two lie one or two faces.
TEST(BadInput, BlocksThinnerThanTwoFaces) {
  for (const double width : {2e-3, 4e-3, 8e-3}) {
    expectWholePairs(sampledOn(grid(24, 0.2), [&](const Vec3& p) {
      return Vec3(width - (p.x() - 0.013) * (p.x() - 0.013), -p.y() + 0.017, 0.0);
    }));
  }
}

TEST(BadInput, MovesToTheBoundaryAndOntoAnother) {
  const VectorField field = sampledOn(grid(40, 0.2), fold);
  const FlatFaces faces(field.charts);
  const Topology topology = findTopology(faces, field);
  const ClosestPointQuery query(field.charts->meshPointer());
  const auto sinks = fixedPointsOf(topology, FixedPointKind::Sink);
  const auto saddles = fixedPointsOf(topology, FixedPointKind::Saddle);
  ASSERT_EQ(sinks.size(), 1u);
  const auto moved = [&](const SurfacePoint& target) {
    return movePoint(faces, field, topology, sinks[0].index, target);
  };
  expectRefused(field, moved(query.closest(Vec3(1.0, 1.0, 0.0)).point), "cannot be moved there");
  expectRefused(field, moved(topology.fixedPoints[saddles[0].index].point), "cannot be moved there");
}

}  // namespace
}  // namespace stormfield::test
