#include "tracking/persistence.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/message.h"
#include "checks.h"
#include "long_tests.h"
#include "tracked_fields.h"
#include "tracking/tracking.h"

namespace stormfield::test {
namespace {

Tracking track(const ParameterizedField& field) {
  Progress progress;
  return trackFixedPoints(field, {}, progress);
}

int indexSum(const Tracking& tracking, double lambda) {
  int sum = 0;
  for (const TrackedPath& path : tracking.paths) {
    if (path.samples.front().lambda <= lambda && lambda <= path.samples.back().lambda) sum += path.index;
  }
  return sum;
}

/// Every inner end is an event of these paths, at their ends.
void expectEndsNamed(const Tracking& tracking, const std::string& what) {
  std::vector<std::array<int, 2>> ends(tracking.paths.size(), {0, 0});
  for (const Bifurcation& event : tracking.bifurcations) {
    if (event.kind == BifurcationKind::Hopf) {
      const TrackedPath& path = tracking.paths[event.paths[0]];
      EXPECT_GE(event.lambda, path.samples.front().lambda) << what;
      EXPECT_LE(event.lambda, path.samples.back().lambda) << what;
      continue;
    }
    const bool creation = event.kind == BifurcationKind::Creation;
    EXPECT_EQ(tracking.paths[event.paths[0]].index, 1) << what;
    EXPECT_EQ(tracking.paths[event.paths[1]].index, -1) << what;
    for (const Index i : event.paths) {
      const auto& samples = tracking.paths[i].samples;
      EXPECT_NEAR(creation ? samples.front().lambda : samples.back().lambda, event.lambda, 1e-12) << what;
      ++ends[i][creation ? 0 : 1];
    }
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    EXPECT_EQ(ends[i][0], tracking.paths[i].begin == PathEnd::Bifurcation) << what;
    EXPECT_EQ(ends[i][1], tracking.paths[i].end == PathEnd::Bifurcation) << what;
  }
}

TEST(TrackingPersistence, KeepsTheIndexSumAndLeavesOnlyLongLives) {
  for (const NamedSurface& s : closedSurfaces()) {
    const auto charts = makeCharts(s.surface);
    for (const ParameterizedField& field :
         {randomHistory(charts, shortOrLong(4, 9), 1), randomIntegerHistory(charts, shortOrLong(3, 6), 2),
          smoothBlend(charts, 12, 3)}) {
      const Tracking all = track(field);
      for (const double minLife : {0.0, 0.01, 0.1, 0.4, 0.9}) {
        const std::string what = message(s.name, ", life ", minLife);
        const Tracking left = persistent(all, {minLife, 0.0});
        expectEndsNamed(left, what);
        Random random(5);
        for (int k = 0; k < 20; ++k) EXPECT_EQ(indexSum(left, random.uniform(0.001, 0.999)), s.euler) << what;
        for (const TrackedPath& path : left.paths) {
          EXPECT_GE(path.life(), minLife) << what;
          for (std::size_t i = 1; i < path.samples.size(); ++i) {
            EXPECT_GE(path.samples[i].lambda, path.samples[i - 1].lambda) << what;
          }
        }
        if (minLife == 0.0) {
          EXPECT_EQ(left.paths.size(), all.paths.size()) << what;
          EXPECT_EQ(left.bifurcations.size(), all.bifurcations.size()) << what;
        }
      }
    }
  }
}

TEST(TrackingPersistence, WorksAtBoundaries) {
  for (const NamedSurface& s : boundedSurfaces()) {
    const auto charts = makeCharts(s.surface);
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const Tracking all = track(randomHistory(charts, 9, seed));
      for (const double minLife : {0.01, 0.1, 0.4, 0.9}) {
        const std::string what = message(s.name, ", life ", minLife, ", seed ", seed);
        const Tracking left = persistent(all, {minLife, 0.0});
        expectEndsNamed(left, what);
        for (const TrackedPath& path : left.paths) EXPECT_GE(path.life(), minLife) << what;
      }
    }
  }
}

TEST(TrackingPersistence, AFoldBecomesOnePath) {
  // The zeros form the curve lambda = 0.5 + 4 x^3 - x / 4: a fold of x in +-0.144, of life 0.048.
  const auto charts = makeCharts(grid(64, 0.1));
  const ParameterizedField field = sampled(charts, evenLambdas(41), [](const Vec3& p, double l) -> Vec3 {
    return {l - 0.5 - 4.0 * p.x() * p.x() * p.x() + 0.25 * p.x(), -(p.y() - 0.01), 0.0};
  });
  const Tracking all = track(field);
  ASSERT_EQ(all.paths.size(), 3u);
  ASSERT_EQ(all.bifurcations.size(), 2u);
  EXPECT_EQ(persistent(all, {0.03, 0.0}).paths.size(), 3u);
  const Tracking left = persistent(all, {0.06, 0.0});
  ASSERT_EQ(left.paths.size(), 1u);
  EXPECT_TRUE(left.bifurcations.empty());
  EXPECT_EQ(left.paths[0].kind, FixedPointKind::Sink);
  EXPECT_EQ(left.paths[0].life(), 1.0);
  EXPECT_EQ(left.paths[0].begin, PathEnd::Range);
  EXPECT_EQ(left.paths[0].end, PathEnd::Range);
}

TEST(TrackingPersistence, LeavesOutTheWeak) {
  const auto charts = makeCharts(grid(16, 0.1));
  const ParameterizedField field = sampled(charts, evenLambdas(3), [](const Vec3& p, double) -> Vec3 {
    return {p.x() * (p.x() - 0.5), p.y() - 0.01, 0.0};
  });
  const Tracking all = track(field);
  ASSERT_EQ(all.paths.size(), 2u);
  EXPECT_EQ(persistent(all, {0.0, 0.5}).paths.size(), 2u);
  EXPECT_EQ(persistent(all, {0.0, 1.0}).paths.size(), 0u);
}

TEST(TrackingPersistence, RefusesOptionsOutOfRange) {
  expectFault<InputError>([] { persistent({}, {-0.1, 0.0}); }, {"shortest life", "-0.1"});
  expectFault<InputError>([] { persistent({}, {0.0, std::numeric_limits<double>::quiet_NaN()}); }, {"strength"});
}

}  // namespace
}  // namespace stormfield::test
