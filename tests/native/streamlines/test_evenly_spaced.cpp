// Spacing and coverage on every kind of surface, loops that close, given curves that stay, and degenerate input.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>

#include "checks.h"
#include "mesh/closest_point.h"
#include "spacing_checks.h"

namespace stormfield {
namespace {

using test::expectFault;
using test::kPi;

VectorField fieldOf(const test::Surface& s, const std::function<Vec3(const Vec3&)>& v) {
  auto charts = test::makeCharts(s);
  const TriangleMesh& mesh = charts->mesh();
  Points vectors(mesh.vertexCount(), 3);
  for (Index i = 0; i < mesh.vertexCount(); ++i) vectors.row(i) = v(mesh.point(i));
  return fromSpace(charts, vectors);
}

EvenStreamlines place(const VectorField& field, double distance, StreamlineFeatures features = {}) {
  return placeStreamlines(FlatFaces(field.charts), field, {.distance = distance}, features);
}

EvenStreamlines placeWithFixedPoints(const VectorField& field, double distance) {
  return place(field, distance, {{}, findFixedPoints(field)});
}

/// A smooth field: the same on every run.
Vec3 swirl(const Vec3& p) {
  return {std::sin(2.1 * p.y() + 0.3) + 0.4 * p.z(), std::cos(1.7 * p.x() + p.z()), std::sin(1.3 * p.x() - p.y())};
}

void expectEven(const VectorField& field, const EvenStreamlines& lines, double d, const std::string& name) {
  EXPECT_LT(test::crowdedPart(field.mesh(), lines, 0.49 * d), 0.05) << name;
  EXPECT_LE(test::largestGap(field, lines), 1.2 * d) << name;
  EXPECT_TRUE(lines.gaps.empty()) << name << ": " << lines.gaps.size();
}

TEST(EvenlySpaced, AConstantFieldOnASquareIsDrawnByEqualDistances) {
  const VectorField field = fieldOf(test::grid(12, 0.3), [](const Vec3&) { return Vec3(1.0, 0.3, 0.0); });
  const EvenStreamlines lines = place(field, 0.1);
  expectEven(field, lines, 0.1, "square");
  EXPECT_LT(test::crowdedPart(field.mesh(), lines, 0.9 * 0.1), 0.05);
  for (const double taper : lines.taper) EXPECT_GE(taper, 0.3);  // all end at the boundary
}

TEST(EvenlySpaced, EverySurfaceIsCoveredAndNoLinesCrowd) {
  std::vector<test::NamedSurface> surfaces = test::closedSurfaces();
  for (auto& s : test::boundedSurfaces()) surfaces.push_back(s);
  surfaces.push_back({"fine sphere", test::icosphere(4), 2});
  surfaces.push_back({"fine torus", test::torus(60, 30), 0});
  surfaces.push_back({"fine genus 2", test::plateWithHoles(2, 6), -2});
  for (const auto& [name, surface, euler] : surfaces) {
    const VectorField field = fieldOf(surface, swirl);
    const double d = 0.06 * field.mesh().size();
    const EvenStreamlines lines = placeWithFixedPoints(field, d);
    expectEven(field, lines, d, name);
  }
}

TEST(EvenlySpaced, TheTwoSidesOfAThinSheetDoNotBlockEachOther) {
  test::Surface thin = test::icosphere(3);
  thin.points.col(2) *= 0.01;
  const VectorField field = fieldOf(thin, [](const Vec3& p) { return Vec3(1.0, 0.2 * p.x(), 0.0); });
  const double d = 0.1;
  const EvenStreamlines lines = place(field, d);
  EXPECT_LE(test::largestGap(field, lines), 1.2 * d);
}

TEST(EvenlySpaced, LinesAroundACenterAreClosed) {
  const VectorField field = fieldOf(test::grid(40, 0.2), [](const Vec3& p) { return Vec3(-p.y(), p.x(), 0.0); });
  const EvenStreamlines lines = placeWithFixedPoints(field, 0.08);
  expectEven(field, lines, 0.08, "center");
  for (std::size_t i = 0; i < lines.closed.size(); ++i) {
    const SurfacePoint& p = lines.points[lines.offsets[i]];
    if (position(field.mesh(), p).norm() < 0.95) {
      EXPECT_TRUE(lines.closed[i]) << i;
    }
  }
}

TEST(EvenlySpaced, LinesAroundASphereAreClosed) {
  const VectorField field = fieldOf(test::icosphere(4), [](const Vec3& p) { return Vec3(-p.y(), p.x(), 0.0); });
  const EvenStreamlines lines = placeWithFixedPoints(field, 0.15);
  expectEven(field, lines, 0.15, "sphere");
  for (std::size_t i = 0; i < lines.closed.size(); ++i) EXPECT_TRUE(lines.closed[i]) << i;
}

TEST(EvenlySpaced, ASpiralIsNotClosed) {
  const auto spiral = [](const Vec3& p) { return Vec3(-p.y() + 0.1 * p.x(), p.x() + 0.1 * p.y(), 0.0); };
  const VectorField field = fieldOf(test::grid(40, 0.2), spiral);
  const EvenStreamlines lines = placeWithFixedPoints(field, 0.08);
  expectEven(field, lines, 0.08, "spiral");
  for (const char closed : lines.closed) EXPECT_FALSE(closed);
}

TEST(EvenlySpaced, PointsFollowTheFlow) {
  const VectorField field = fieldOf(test::icosphere(4), swirl);
  const EvenStreamlines lines = placeWithFixedPoints(field, 0.12);
  double worst = 1.0;
  for (std::size_t i = 0; i + 1 < lines.offsets.size(); ++i) {
    for (std::size_t k = lines.offsets[i]; k + 1 < lines.offsets[i + 1]; ++k) {
      const SurfacePoint &a = lines.points[k], &b = lines.points[k + 1];
      const Vec3 way = position(field.mesh(), b) - position(field.mesh(), a);
      const Vec3 flow = evaluate(field, a) + evaluate(field, b);
      if (flow.norm() > 0.2 && way.norm() > 1e-6) worst = std::min(worst, way.dot(flow) / way.norm() / flow.norm());
      EXPECT_GE(lines.arc[k + 1], lines.arc[k]);
    }
  }
  EXPECT_GT(worst, 0.9);
}

TEST(EvenlySpaced, AGivenOrbitStaysWholeAndOthersLeaveItRoom) {
  const auto attracted = [](const Vec3& p) {
    const double r = std::hypot(p.x(), p.y()), inward = 0.25 - r * r;
    return Vec3(-p.y() + inward * p.x(), p.x() + inward * p.y(), 0.0);
  };
  const VectorField field = fieldOf(test::grid(60), attracted);
  const ClosestPointQuery query(field.charts->meshPointer());
  GivenCurve orbit{{}, true, false};
  for (int i = 0; i < 400; ++i) {
    const double angle = 2.0 * kPi * i / 400;
    orbit.points.push_back(query.closest(Vec3(0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.0)).point);
  }
  const double d = 0.08;
  const EvenStreamlines lines = place(field, d, {{orbit}, findFixedPoints(field)});
  expectEven(field, lines, d, "orbit");
  ASSERT_EQ(lines.given.front(), 0);
  EXPECT_TRUE(lines.closed.front());
  EXPECT_GT(lines.arc[lines.offsets[1] - 1], 0.97 * kPi);
  EXPECT_EQ(std::count(lines.given.begin(), lines.given.end(), 0), 1);
}

TEST(EvenlySpaced, ASeparatrixEndsBeforeItCrowdsWhatItLeadsTo) {
  const VectorField field = fieldOf(test::grid(20), [](const Vec3& p) { return Vec3(p.x(), -p.y(), 0.0); });
  const ClosestPointQuery query(field.charts->meshPointer());
  const auto straight = [&](const Vec3& from, const Vec3& to) {
    GivenCurve curve;
    for (int i = 0; i <= 300; ++i) curve.points.push_back(query.closest(Vec3(from + i / 300.0 * (to - from))).point);
    return curve;
  };
  const Vec3 right(0.9, 0.0, 0.0), zero(0.0, 0.0, 0.0), top(0.0, 0.9, 0.0), above(0.85, 0.3, 0.0),
      below(0.85, -0.3, 0.0);
  GivenCurve incoming = straight(zero, top);
  incoming.againstFlow = true;
  const double d = 0.1;
  const EvenStreamlines lines = place(field, d, {{straight(above, below), straight(zero, right), incoming}, {}});
  ASSERT_EQ(lines.given[0], 0);
  ASSERT_EQ(lines.given[1], 1);
  ASSERT_EQ(lines.given[2], 2);
  EXPECT_NEAR(position(field.mesh(), lines.points[lines.offsets[2] - 1]).x(), 0.8, 0.03);  // d / 2 before the first
  test::expectNear(position(field.mesh(), lines.points[lines.offsets[1]]), zero, 1e-9, "both begin at the saddle");
  test::expectNear(position(field.mesh(), lines.points[lines.offsets[3] - 1]), zero, 1e-9, "turned with the flow");
}

TEST(EvenlySpaced, AFieldOfZerosHasNoLines) {
  const EvenStreamlines lines = placeWithFixedPoints(test::zeroField(test::makeCharts(test::torus(12, 8))), 0.1);
  EXPECT_EQ(lines.offsets.size(), 1U);
  EXPECT_DOUBLE_EQ(lines.quietArea, 1.0);
  EXPECT_TRUE(lines.gaps.empty());
}

TEST(EvenlySpaced, WhereTheFieldStandsStillThereAreNoLines) {
  const auto half = [](const Vec3& p) { return Vec3(0.0, std::max(0.0, p.x()), 0.0); };
  const VectorField field = fieldOf(test::grid(30), half);
  const EvenStreamlines lines = place(field, 0.1);
  expectEven(field, lines, 0.1, "half");
  EXPECT_NEAR(lines.quietArea, 0.5, 1e-9);
  for (const SurfacePoint& p : lines.points) EXPECT_GE(position(field.mesh(), p).x(), -1e-9);
}

TEST(EvenlySpaced, OneTriangleAndOneLargeSquareAreCovered) {
  const VectorField one =
      fieldOf(test::surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), [](const Vec3&) { return Vec3(1, 2, 0); });
  expectEven(one, place(one, 0.02), 0.02, "triangle");
  const VectorField two = fieldOf(test::grid(1), [](const Vec3& p) { return Vec3(1, p.x(), 0); });
  expectEven(two, place(two, 0.05), 0.05, "square of two triangles");
}

TEST(EvenlySpaced, RandomFieldsOnRandomSurfacesEnd) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto charts = test::makeCharts(test::bumpySphere(2, 0.4, seed));
    for (const VectorField& field : {test::randomField(charts, seed), test::randomIntegerField(charts, seed)}) {
      const double d = 0.08 * field.mesh().size();
      const EvenStreamlines lines = placeWithFixedPoints(field, d);
      // The faces turn so much from one to the next that only the distance in space means something.
      EXPECT_LE(test::largestGap(field, lines, -2.0), 1.2 * d) << seed << ", " << lines.gaps.size();
    }
  }
}

TEST(EvenlySpaced, TheResultDoesNotDependOnTheNumberOfThreads) {
  const VectorField field = fieldOf(test::icosphere(4), swirl);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return placeWithFixedPoints(field, 0.1);
  };
  const EvenStreamlines one = with(1), four = with(4);
  EXPECT_EQ(one.offsets, four.offsets);
  EXPECT_EQ(one.arc, four.arc);
  EXPECT_EQ(one.taper, four.taper);
  EXPECT_EQ(one.closed, four.closed);
}

TEST(EvenlySpaced, ScalingTheSurfaceOrTheSpeedChangesNothingElse) {
  test::Surface large = test::icosphere(3);
  const VectorField field = fieldOf(large, swirl);
  large.points *= 1024.0;
  const VectorField scaled = fieldOf(large, [](const Vec3& p) { return Vec3(4.0 * swirl(p / 1024.0)); });
  const EvenStreamlines a = placeWithFixedPoints(field, 0.15), b = placeWithFixedPoints(scaled, 0.15 * 1024.0);
  EXPECT_EQ(a.offsets, b.offsets);
}

TEST(EvenlySpaced, BadInputIsNamed) {
  const VectorField field = fieldOf(test::grid(4), [](const Vec3&) { return Vec3(1, 0, 0); });
  for (const double distance : {0.0, -1.0, 1e-9, std::numeric_limits<double>::quiet_NaN()}) {
    expectFault<InputError>([&] { place(field, distance); }, {"distance", "give at least"});
  }
  expectFault<InputError>([&] { place(field, 0.1, {{GivenCurve{}}, {}}); }, {"given curve 0"});
  const VectorField other = fieldOf(test::grid(5), [](const Vec3&) { return Vec3(1, 0, 0); });
  expectFault<InputError>([&] { placeStreamlines(FlatFaces(field.charts), other, {.distance = 0.1}); },
                          {"another mesh"});
}

TEST(EvenlySpaced, ALargeDistanceStillDrawsSomething) {
  const VectorField field = fieldOf(test::icosphere(2), swirl);
  EXPECT_GE(place(field, 10.0).offsets.size(), 2U);
}

TEST(EvenlySpaced, CancellingStops) {
  const VectorField field = fieldOf(test::icosphere(3), swirl);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(placeStreamlines(FlatFaces(field.charts), field, {.distance = 0.02}, {}, &progress), Cancelled);
}

}  // namespace
}  // namespace stormfield
