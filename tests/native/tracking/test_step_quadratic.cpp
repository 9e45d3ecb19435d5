#include "tracking/detail/step_quadratic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/message.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

/// Roots in [0, 1] of c0 (1 - t)^2 + c1 (1 - t) t + c2 t^2, in long double: by bisection between the extreme and the
/// ends, which shares nothing with the formula.
std::vector<long double> referenceRoots(const StepQuadratic& q) {
  const long double c0 = q.c[0], c1 = q.c[1], c2 = q.c[2];
  const auto value = [&](long double t) { return c0 * (1 - t) * (1 - t) + c1 * (1 - t) * t + c2 * t * t; };
  std::vector<long double> ends{0.0L};
  const long double curvature = 2 * (c0 - c1 + c2);
  if (curvature != 0) {
    const long double extreme = (2 * c0 - c1) / curvature;
    if (extreme > 0 && extreme < 1) ends.push_back(extreme);
  }
  ends.push_back(1.0L);
  std::vector<long double> roots;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    long double a = ends[i], b = ends[i + 1];
    if (value(a) == 0 || (value(a) > 0) == (value(b) > 0)) continue;
    const bool above = value(a) > 0;
    for (int step = 0; step < 200; ++step) {
      const long double middle = (a + b) / 2;
      ((value(middle) > 0) == above ? a : b) = middle;
    }
    roots.push_back((a + b) / 2);
  }
  return roots;
}

void expectRoots(const StepQuadratic& q, const std::vector<double>& expected, double tolerance = 1e-15) {
  const StepQuadratic::Roots roots = q.roots();
  const std::string what = message("quadratic ", q.c[0], ", ", q.c[1], ", ", q.c[2]);
  ASSERT_EQ(roots.count, static_cast<int>(expected.size())) << what;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(roots.times[i].t, expected[i], tolerance) << what;
    EXPECT_NEAR(roots.times[i].t + roots.times[i].u, 1.0, 1e-15) << what;
  }
}

TEST(StepQuadratic, HasNoRootsWhereItIsPositive) {
  expectRoots({{1.0, 0.0, 1.0}}, {});
  expectRoots({{1.0, 5.0, 1.0}}, {});   // both roots outside
  expectRoots({{1.0, -1.9, 1.0}}, {});  // the minimum is just above 0
  expectRoots({{-2.0, -1.0, -3.0}}, {});
}

TEST(StepQuadratic, HasTwoRootsInOrder) {
  // (t - a)(t - b) in u and t: a b u^2 + (2 a b - a - b) u t + (1 - a)(1 - b) t^2.
  for (const auto& [a, b] : {std::pair(0.25, 0.75), std::pair(0.125, 0.5), std::pair(0.5, 0.9375)}) {
    const StepQuadratic q{{a * b, 2.0 * a * b - a - b, (1.0 - a) * (1.0 - b)}};
    expectRoots(q, {a, b});
    expectRoots({{-q.c[0], -q.c[1], -q.c[2]}}, {a, b});
    EXPECT_NEAR(q.slope(q.roots().times[0]), a - b, 1e-14);
    EXPECT_NEAR(q.slope(q.roots().times[1]), b - a, 1e-14);
  }
}

TEST(StepQuadratic, HasOneRootWhereItsEndsDifferInSign) {
  expectRoots({{1.0, 0.0, -1.0}}, {0.5});
  expectRoots({{-1.0, 0.0, 4.0}}, {1.0 / 3.0});
  expectRoots({{3.0, 7.0, -2.0}}, {static_cast<double>(referenceRoots({{3.0, 7.0, -2.0}}).at(0))});
}

TEST(StepQuadratic, HasADoubleRootTwice) {
  expectRoots({{1.0, -2.0, 1.0}}, {0.5, 0.5});
  expectRoots({{1.0, -6.0, 9.0}}, {0.25, 0.25});
  expectRoots({{-9.0, 6.0, -1.0}}, {0.75, 0.75});
}

TEST(StepQuadratic, HasRootsAtItsEnds) {
  expectRoots({{0.0, 1.0, 0.0}}, {0.0, 1.0});
  expectRoots({{0.0, -1.0, 0.0}}, {0.0, 1.0});
  expectRoots({{0.0, 2.0, -1.0}}, {0.0, 2.0 / 3.0});
  expectRoots({{-1.0, 2.0, 0.0}}, {1.0 / 3.0, 1.0});
  // The other root is outside.
  expectRoots({{0.0, 1.0, 1.0}}, {0.0});
  expectRoots({{1.0, 1.0, 0.0}}, {1.0});
  // Exactly, on both sides: crossings at samples are recognized by t == 0 and u == 0.
  EXPECT_EQ((StepQuadratic{{0.0, 3.0, -7.0}}.roots().times[0].t), 0.0);
  EXPECT_EQ((StepQuadratic{{-7.0, 3.0, 0.0}}.roots().times[1].u), 0.0);
}

TEST(StepQuadratic, MayBeDegenerate) {
  expectRoots({{0.0, 0.0, 0.0}}, {});        // zero everywhere: no event
  expectRoots({{2.0, 4.0, 2.0}}, {});        // constant
  expectRoots({{1.0, -2.0, -3.0}}, {0.25});  // linear: 1 - 4 t
  expectRoots({{-1.0, 1.0, 2.0}}, {referenceRoots({{-1.0, 1.0, 2.0}}).at(0) > 0 ? 1.0 / 3.0 : 0.0});  // linear: 3 t - 1
  expectRoots({{0.0, 0.0, 1.0}}, {0.0});                                                              // t^2
  expectRoots({{1.0, 0.0, 0.0}}, {1.0});                                                              // u^2
}

TEST(StepQuadratic, DoesNotCancel) {
  // One root near an end: the textbook formula loses it in 1 - sqrt(1 - tiny).
  for (const double tiny : {1e-3, 1e-8, 1e-12, 1e-15}) {
    for (const StepQuadratic& q : {StepQuadratic{{tiny, -1.0, 0.5}}, StepQuadratic{{0.5, -1.0, tiny}},
                                   StepQuadratic{{tiny, 1.0, -1e-3}}, StepQuadratic{{-tiny, 1.0, tiny}}}) {
      const auto reference = referenceRoots(q);
      const StepQuadratic::Roots roots = q.roots();
      ASSERT_EQ(roots.count, static_cast<int>(reference.size())) << tiny;
      for (int i = 0; i < roots.count; ++i) {
        // Relative to the distance from either end.
        EXPECT_NEAR(roots.times[i].t / static_cast<double>(reference[i]), 1.0, 1e-13) << tiny;
      }
    }
  }
  // Symmetric: the distance from the far end is as exact as that from the near one.
  const StepQuadratic near{{1e-100, -1.0, 0.25}}, far{{0.25, -1.0, 1e-100}};
  EXPECT_EQ(near.roots().times[0].t, far.roots().times[1].u);
  EXPECT_NEAR(near.roots().times[0].t / 1e-100, 1.0, 1e-13);
}

TEST(StepQuadratic, AgreesWithLongDoubleOnRandomCoefficients) {
  Random random(3);
  int both = 0;
  for (int i = 0; i < 20000; ++i) {
    const StepQuadratic q{{random.uniform(), 3.0 * random.uniform(), random.uniform()}};
    const double discriminant = q.c[1] * q.c[1] - 4.0 * q.c[0] * q.c[2];
    if (std::abs(discriminant) < 1e-6) continue;  // double roots are ill-conditioned
    const auto reference = referenceRoots(q);
    const StepQuadratic::Roots roots = q.roots();
    ASSERT_EQ(roots.count, static_cast<int>(reference.size())) << q.c[0] << " " << q.c[1] << " " << q.c[2];
    for (int k = 0; k < roots.count; ++k) {
      EXPECT_NEAR(roots.times[k].t, static_cast<double>(reference[k]), 1e-12);
    }
    both += roots.count == 2 ? 1 : 0;
  }
  EXPECT_GT(both, 1000);
}

TEST(StepQuadratic, BoundsAreSufficient) {
  const StepQuadratic q{{1.0, 0.5, 2.0}};
  EXPECT_TRUE(q.above(0.4));
  EXPECT_FALSE(q.above(0.5));
  EXPECT_TRUE(q.below(2.1));
  EXPECT_FALSE(q.below(2.0));
  EXPECT_EQ(q.size(), 3.5);
  EXPECT_NEAR(q.slope({0.0, 1.0}), 0.5 - 2.0, 1e-15);
  EXPECT_NEAR(q.slope({1.0, 0.0}), 4.0 - 0.5, 1e-15);
}

}  // namespace
}  // namespace stormfield::test
