// Where and when an element acts: against integrals and limits.
#include "design/detail/region.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stormfield {
namespace {

TEST(Region, FallsSmoothlyToItsRim) {
  EXPECT_EQ(falloff(0.0), 1.0);
  EXPECT_EQ(falloff(1.0), 0.0);
  EXPECT_EQ(falloff(2.0), 0.0);
  constexpr double kStep = 1e-6;
  EXPECT_NEAR((falloff(1.0 - kStep) - falloff(1.0)) / kStep, 0.0, 1e-5);
  for (double t = 0.0; t < 1.0; t += 0.1) EXPECT_GT(falloff(t), falloff(t + 0.1));
  EXPECT_EQ(smoothStep(-1.0), 0.0);
  EXPECT_EQ(smoothStep(0.5), 0.5);
  EXPECT_EQ(smoothStep(2.0), 1.0);
}

TEST(Region, SharesOfAllSamplesAddUpToTheTimeThatTheElementActs) {
  for (const int samples : {11, 50, 101}) {
    const double step = 1.0 / (samples - 1);
    LambdaSpan span;
    span.start = 0.3;
    span.end = 0.62;
    double sum = 0.0;
    for (int j = 0; j < samples; ++j) sum += step * span.share(j * step, step);
    // The smooth ends add half of their width each.
    EXPECT_NEAR(sum, span.end - span.start + span.fade, 0.02 * step + 1e-3) << samples;
  }
}

TEST(Region, ActsOnWholeCellsAtTheEndsOfLambda) {
  const LambdaSpan span;  // 0..1
  EXPECT_EQ(span.share(0.0, 0.1), 1.0);
  EXPECT_EQ(span.share(1.0, 0.1), 1.0);
  EXPECT_EQ(span.share(0.5, 0.1), 1.0);
}

TEST(Region, IsZeroFarFromItsSpanAndOneInside) {
  LambdaSpan span;
  span.start = 0.4;
  span.end = 0.6;
  EXPECT_EQ(span.share(0.2, 0.05), 0.0);
  EXPECT_EQ(span.share(0.8, 0.05), 0.0);
  EXPECT_EQ(span.share(0.5, 0.05), 1.0);
  EXPECT_TRUE(span.contains(0.4) && span.contains(0.6) && !span.contains(0.39) && !span.contains(0.61));
}

TEST(Region, GivesTheSampleOnAJoinedEndToItsOwner) {
  LambdaSpan before, after;
  before.end = after.start = 0.5;
  before.endJoined = after.startJoined = true;
  before.ownsEnd = false;
  EXPECT_FALSE(before.contains(0.5));
  EXPECT_TRUE(after.contains(0.5));
  EXPECT_EQ(before.share(0.5, 0.1), 0.0);
  EXPECT_EQ(after.share(0.5, 0.1), 1.0);
  // No fade beyond a joined end, whole cells before it.
  EXPECT_EQ(before.share(0.6, 0.1), 0.0);
  EXPECT_EQ(before.share(0.4, 0.1), 1.0);
}

}  // namespace
}  // namespace stormfield
