#include "tracking/tracked_paths.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"

namespace stormfield::test {
namespace {

TrackedPath pathOf(int index, const std::vector<std::pair<double, FixedPointKind>>& samples) {
  TrackedPath path;
  path.index = index;
  for (const auto& [lambda, kind] : samples) path.samples.push_back({lambda, {3, {0.2, 0.3, 0.5}}, {1, 2, 3}, kind});
  return path;
}

TrackedPath node() {
  return pathOf(1, {{0.2, FixedPointKind::Source}, {0.6, FixedPointKind::Sink}, {1.0, FixedPointKind::Sink}});
}

TrackedPath saddle() {
  return pathOf(-1, {{0.2, FixedPointKind::Saddle}, {1.0, FixedPointKind::Saddle}});
}

Bifurcation eventOf(BifurcationKind kind, double lambda, std::array<Index, 2> paths) {
  return {lambda, {3, {0.2, 0.3, 0.5}}, {1, 2, 3}, kind, FixedPointKind::Sink, paths};
}

/// The message of the InputError, empty without one.
std::string refusal(std::vector<TrackedPath> paths, std::vector<Bifurcation> events = {}) {
  try {
    makeTracking(std::move(paths), std::move(events));
  } catch (const InputError& fault) {
    return fault.what();
  }
  return "";
}

TEST(TrackedPaths, ThePrevailingKindHasTheLongestShareOfLambda) {
  EXPECT_EQ(prevailingKind(node().samples), FixedPointKind::Sink);
  EXPECT_EQ(prevailingKind(pathOf(1, {{0.5, FixedPointKind::Center}}).samples), FixedPointKind::Center);
  // Half of each interval belongs to either end: the source has 0.5, the sink 0.5, and the first kind wins.
  const auto even = pathOf(1, {{0.0, FixedPointKind::Sink}, {1.0, FixedPointKind::Source}});
  EXPECT_EQ(prevailingKind(even.samples), std::min(FixedPointKind::Source, FixedPointKind::Sink));
}

TEST(TrackedPaths, ATrackingOfGivenPathsKeepsThemAndFindsTheirKinds) {
  const Tracking made = makeTracking({node(), saddle()}, {eventOf(BifurcationKind::Creation, 0.2, {0, 1}),
                                                          eventOf(BifurcationKind::Hopf, 0.4, {0, kNone})});
  ASSERT_EQ(made.paths.size(), 2u);
  ASSERT_EQ(made.bifurcations.size(), 2u);
  EXPECT_EQ(made.paths[0].kind, FixedPointKind::Sink);
  EXPECT_EQ(made.paths[1].kind, FixedPointKind::Saddle);
  EXPECT_DOUBLE_EQ(made.paths[0].life(), 0.8);
  EXPECT_EQ(made.bifurcations[0].paths, (std::array<Index, 2>{0, 1}));
  EXPECT_TRUE(makeTracking({}, {}).paths.empty());
}

TEST(TrackedPaths, PiecesMayShareALambda) {
  const auto joined =
      pathOf(1, {{0.2, FixedPointKind::Sink}, {0.5, FixedPointKind::Sink}, {0.5, FixedPointKind::Sink}});
  EXPECT_EQ(refusal({joined}), "");
}

TEST(TrackedPaths, WhatDoesNotFitIsNamed) {
  const auto contains = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  contains(refusal({node(), pathOf(1, {})}), "path 1 has no samples");
  contains(refusal({pathOf(2, {{0.5, FixedPointKind::Sink}})}), "path 0 has index 2");
  contains(refusal({pathOf(0, {{0.5, FixedPointKind::Sink}})}), "path 0 has index 0");
  contains(refusal({pathOf(1, {{0.5, FixedPointKind::Sink}, {0.4, FixedPointKind::Sink}})}),
           "goes back from lambda 0.5");
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {-0.1, 1.1, nothing, std::numeric_limits<double>::infinity()}) {
    contains(refusal({pathOf(1, {{wrong, FixedPointKind::Sink}})}), "path 0 has a sample at lambda");
    contains(refusal({node()}, {eventOf(BifurcationKind::Hopf, wrong, {0, kNone})}), "bifurcation 0 is at lambda");
  }
  auto outside = node();
  outside.samples[1].point.face = kNone;
  contains(refusal({outside}), "on face -1");
}

TEST(TrackedPaths, BifurcationsNamePathsThatAreThere) {
  const auto refused = [](BifurcationKind kind, std::array<Index, 2> paths) {
    return refusal({node(), saddle()}, {eventOf(kind, 0.5, paths)});
  };
  EXPECT_EQ(refused(BifurcationKind::Annihilation, {0, 1}), "");
  EXPECT_EQ(refused(BifurcationKind::Hopf, {1, kNone}), "");
  EXPECT_NE(refused(BifurcationKind::Creation, {0, 2}).find("names path 2 of 2"), std::string::npos);
  EXPECT_NE(refused(BifurcationKind::Creation, {0, kNone}).find("names path -1 of 2"), std::string::npos);
  EXPECT_NE(refused(BifurcationKind::Creation, {1, 1}).find("twice"), std::string::npos);
  EXPECT_NE(refused(BifurcationKind::Hopf, {0, 1}).find("names 2 paths"), std::string::npos);
  EXPECT_NE(refused(BifurcationKind::Hopf, {7, kNone}).find("names path 7 of 2"), std::string::npos);
}

}  // namespace
}  // namespace stormfield::test
