#include "tracing/pathline.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "fixtures.h"
#include "tracing/streamline.h"

namespace stormfield {
namespace {

TEST(LambdaTrack, SegmentsFollowSamplesAndTimes) {
  const auto segments =
      timeSegments({0.0, 0.5, 1.0}, {.times = {0.0, 10.0, 20.0, 30.0}, .lambdas = {0.0, 1.0, 1.0, 0.75}});
  ASSERT_EQ(segments.size(), 6U);
  EXPECT_EQ(segments[1].sample, 0);
  EXPECT_EQ(segments[1].end, 5.0);
  EXPECT_EQ(segments[2].sample, 1);
  EXPECT_NEAR(segments[2].theta(7.5), 0.5, 1e-15);
  EXPECT_NEAR(segments[3].theta(15.0), 1.0, 1e-15);
  EXPECT_NEAR(segments[4].theta(30.0), 0.5, 1e-15);
  for (std::size_t i = 1; i < segments.size(); ++i) EXPECT_EQ(segments[i].begin, segments[i - 1].end);
}

TEST(LambdaTrack, JoinsWhatIsOneLine) {
  LambdaTrack track;
  for (int i = 0; i <= 100; ++i) {
    track.times.push_back(i / 24.0);
    track.lambdas.push_back(0.01 * i);
  }
  EXPECT_EQ(timeSegments({0.0, 0.5, 1.0}, track).size(), 4U);
  EXPECT_EQ(timeSegments({0.3}, track).size(), 1U);
}

TEST(LambdaTrack, RefusesBadInput) {
  EXPECT_THROW(timeSegments({0.0}, {}), InputError);
  EXPECT_THROW(timeSegments({0.0}, {{0.0, 0.0}, {0.0, 1.0}}), InputError);
  EXPECT_THROW(timeSegments({0.0}, {{0.0, 1.0}, {0.0}}), InputError);
  EXPECT_THROW(timeSegments({0.0}, {{0.0}, {std::numeric_limits<double>::quiet_NaN()}}), InputError);
}

TEST(Pathline, ConstantFieldAgreesWithStreamlines) {
  const auto charts = test::makeCharts(test::torus(30, 16, 1.0, 0.4, 0.2));
  const FlatFaces faces(charts);
  const VectorField steady = sampled(charts, analytic::swirl());
  const ParameterizedField field = test::blend({steady, steady, steady});
  const UnsteadyField flow(faces, field, {.times = {0.0, 0.3, 2.0}, .lambdas = {0.0, 1.0, 0.2}});
  for (const Direction direction : {Direction::Forward, Direction::Backward}) {
    const TraceOptions options{.direction = direction, .maxTime = 0.8, .tolerance = 1e-8};
    const auto seeds = test::randomSeeds(charts->mesh(), 200, 5);
    std::vector<PathlineSeed> starts;
    for (const SurfacePoint& p : seeds) starts.push_back({p, 0.9});
    const auto lines = traceStreamlineEnds(faces, steady, seeds, options);
    const auto paths = tracePathlineEnds(flow, starts, options);
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      if (lines[i].reason != StopReason::Time) continue;
      EXPECT_EQ(paths[i].time, 0.8);
      EXPECT_LT((position(charts->mesh(), lines[i].point) - position(charts->mesh(), paths[i].point)).norm(), 1e-5);
    }
  }
}

TEST(Pathline, LinearInTimeIsExactInThePlane) {
  const auto charts = test::makeCharts(test::grid(12, 0.3));
  const FlatFaces faces(charts);
  const Vec3 a(0.3, 0.0, 0.0), b(-0.1, 0.4, 0.0);
  const auto constant = [&](const Vec3& v) { return sampled(charts, [&](const Vec3&) { return v; }); };
  const ParameterizedField field = test::blend({constant(a), constant(b)});
  const UnsteadyField flow(faces, field, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}}, 0.5);
  for (const SurfacePoint& seed : test::randomSeeds(charts->mesh(), 200, 2)) {
    if (position(charts->mesh(), seed).norm() > 0.6) continue;
    // From t = 0.25: the integral of (1 - s) a + s b, at half speed.
    const TraceEnd end = tracePathlineEnds(flow, {{seed, 0.25, 0.5}}, {}).front();
    const Vec3 expected = 0.5 * (0.5 * a + (0.75 * 0.75 - 0.25 * 0.25) / 2.0 * (b - a));
    EXPECT_NEAR((position(charts->mesh(), end.point) - position(charts->mesh(), seed) - expected).norm(), 0.0, 1e-12);
    EXPECT_EQ(end.time, 0.5);
  }
}

TEST(Pathline, ForwardThenBackwardReturnsAtVerticesToo) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  const FlatFaces faces(charts);
  const ParameterizedField field =
      test::blend({sampled(charts, analytic::swirl()), sampled(charts, analytic::swirl(1.0)),
                   sampled(charts, analytic::swirl(2.0))});
  const UnsteadyField flow(faces, field, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}});
  std::vector<PathlineSeed> seeds;
  for (Index v = 0; v < charts->mesh().vertexCount(); v += 5)
    seeds.push_back({vertexPoint(charts->mesh(), v), 0.2, 0.6});
  const auto there = tracePathlineEnds(flow, seeds, {.tolerance = 1e-8});
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    EXPECT_EQ(there[i].reason, StopReason::Time);
    const auto back =
        tracePathlineEnds(flow, {{there[i].point, 0.8, 0.6}}, {.direction = Direction::Backward, .tolerance = 1e-8});
    EXPECT_LT((position(charts->mesh(), back[0].point) - position(charts->mesh(), seeds[i].point)).norm(), 1e-5);
  }
}

TEST(Pathline, ParticleAtRestIsSetInMotion) {
  const auto charts = test::makeCharts(test::grid(6));
  const FlatFaces faces(charts);
  const auto constant = [&](double speed) {
    return sampled(charts, [&](const Vec3&) { return Vec3(speed, 0.3 * speed, 0.0); });
  };
  const ParameterizedField field = test::blend({constant(0.0), constant(0.0), constant(0.4)});
  const UnsteadyField flow(faces, field, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}});
  for (const SurfacePoint& seed : {vertexPoint(charts->mesh(), 24), SurfacePoint{30, {0.2, 0.3, 0.5}}}) {
    const TraceEnd end = tracePathlineEnds(flow, {{seed, 0.0, 1.0}}, {}).front();
    EXPECT_EQ(end.time, 1.0);
    // Rest until 0.5, then speed rises linearly: a distance of 0.1.
    const Vec3 way = position(charts->mesh(), end.point) - position(charts->mesh(), seed);
    EXPECT_NEAR((way - Vec3(0.1, 0.03, 0.0)).norm(), 0.0, 1e-6);
  }
}

TEST(Pathline, WaitsAtACornerOfTheBoundaryUntilTheFlowTurns) {
  const auto charts = test::makeCharts(test::grid(6));
  const FlatFaces faces(charts);
  const auto constant = [&](double x, double y) {
    return sampled(charts, [=](const Vec3&) { return Vec3(x, y, 0.0); });
  };
  const ParameterizedField field = test::blend({constant(1.0, 1.0), constant(-1.0, -1.0)});
  const UnsteadyField flow(faces, field, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}});
  const TraceEnd end =
      tracePathlineEnds(flow, {{vertexPoint(charts->mesh(), 48), 0.0, 1.0}}, {.boundary = BoundaryRule::Slide}).front();
  EXPECT_EQ(end.time, 1.0);
  EXPECT_NEAR((position(charts->mesh(), end.point) - Vec3(0.75, 0.75, 0.0)).norm(), 0.0, 0.02);
}

TEST(Pathline, NeverLoopsForEver) {
  const std::vector<test::ChartsPointer> meshes = {test::makeCharts(test::dividedIcosahedron(5)),
                                                   test::makeCharts(test::cube()),
                                                   test::makeCharts(test::grid(9, 0.45))};
  for (unsigned run = 0; run < 12; ++run) {
    const auto& charts = meshes[run % meshes.size()];
    const FlatFaces faces(charts);
    const ParameterizedField field = test::blend(
        {test::randomField(charts, run), test::randomField(charts, run + 50), test::randomField(charts, run + 99)});
    const UnsteadyField flow(faces, field, {.times = {0.0, 1.0, 1.5}, .lambdas = {0.0, 1.0, 0.3}});
    std::vector<PathlineSeed> seeds;
    for (const SurfacePoint& p : test::randomSeeds(charts->mesh(), 100, run)) seeds.push_back({p, 2.0, 2.5});
    for (Index v = 0; v < charts->mesh().vertexCount(); ++v)
      seeds.push_back({vertexPoint(charts->mesh(), v), 2.0, 2.5});
    for (const BoundaryRule rule : {BoundaryRule::Stop, BoundaryRule::Slide}) {
      const auto ends = tracePathlineEnds(flow, seeds, {.direction = Direction::Backward, .boundary = rule});
      for (const TraceEnd& end : ends) {
        EXPECT_NE(end.reason, StopReason::StepLimit);
        EXPECT_LE(end.time, 2.5);
        EXPECT_TRUE(rule == BoundaryRule::Stop || end.reason == StopReason::Time);
      }
    }
  }
}

}  // namespace
}  // namespace stormfield
