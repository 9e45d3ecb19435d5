// Where singularity paths meet, and what cannot be joined.
#include "design/detail/junction.h"

#include <gtest/gtest.h>

#include "checks.h"

namespace stormfield {
namespace {

DesignElement moving(const std::string& name, const Vec3& from, const Vec3& to, double start, double end) {
  DesignElement element;
  element.name = name;
  element.kind = SingularKind::VortexCcw;
  element.points = {from, to};
  element.lambdas = {start, end};
  element.radius = 0.2;
  return element;
}

const Vec3 kMeeting(0.5, 0.5, 0.0);

std::vector<DesignElement> mergeOfTwo() {
  return {moving("west", {0, 0, 0}, kMeeting, 0.0, 0.6), moving("east", {1, 0, 0}, kMeeting, 0.0, 0.6),
          moving("one", kMeeting, {0.5, 1, 0}, 0.6, 1.0)};
}

TEST(Junction, IsAMergeASplitOrAContinuation) {
  const std::vector<DesignElement> elements = mergeOfTwo();
  const std::vector<Junction> merge = findJunctions(elements, 0.01);
  ASSERT_EQ(merge.size(), 1u);
  EXPECT_EQ(merge[0].kind, Junction::Kind::Merge);
  EXPECT_EQ(merge[0].pair(), (std::vector<Index>{0, 1}));
  EXPECT_EQ(merge[0].single(), 2);
  EXPECT_EQ(merge[0].lambda, 0.6);
  test::expectNear(merge[0].point, kMeeting, 0.0);

  const std::vector<DesignElement> back = {moving("one", {0.5, 1, 0}, kMeeting, 0.0, 0.4),
                                           moving("west", kMeeting, {0, 0, 0}, 0.4, 1.0),
                                           moving("east", kMeeting, {1, 0, 0}, 0.4, 1.0)};
  const std::vector<Junction> split = findJunctions(back, 0.01);
  ASSERT_EQ(split.size(), 1u);
  EXPECT_EQ(split[0].kind, Junction::Kind::Split);
  EXPECT_EQ(split[0].pair(), (std::vector<Index>{1, 2}));
  EXPECT_EQ(split[0].single(), 0);

  const std::vector<Junction> continued = findJunctions({elements[0], elements[2]}, 0.01);
  ASSERT_EQ(continued.size(), 1u);
  EXPECT_EQ(continued[0].kind, Junction::Kind::Continuation);
}

TEST(Junction, NeedsOnePlaceAndOneLambda) {
  std::vector<DesignElement> apart = mergeOfTwo();
  apart[1].points.back() += Vec3(0.06, 0.0, 0.0);  // more than a quarter of the radius
  EXPECT_EQ(findJunctions(apart, 0.01).front().kind, Junction::Kind::Continuation);
  EXPECT_EQ(findJunctions(apart, 0.1).front().kind, Junction::Kind::Merge);  // less than an edge
  std::vector<DesignElement> early = mergeOfTwo();
  early[1].lambdas.back() = 0.55;
  EXPECT_EQ(findJunctions(early, 0.01).front().kind, Junction::Kind::Continuation);
  // Ends at lambda 0 and 1 are no junctions.
  EXPECT_TRUE(findJunctions({moving("a", {0, 0, 0}, kMeeting, 0.0, 1.0)}, 0.01).empty());
}

TEST(Junction, MovesTheEndsToOnePoint) {
  std::vector<DesignElement> elements = mergeOfTwo();
  elements[0].points.back() += Vec3(0.01, 0.0, 0.0);
  elements[1].lambdas.back() = 0.6004;
  const std::vector<DesignElement> joined = joinedEnds(elements, findJunctions(elements, 0.05));
  for (const std::size_t i : {0, 1}) {
    test::expectNear(joined[i].points.back(), kMeeting, 0.0);
    EXPECT_EQ(joined[i].lambdas.back(), 0.6);
  }
  test::expectNear(joined[0].points.front(), Vec3::Zero(), 0.0);
}

TEST(Junction, RefusesWhatCannotBeJoinedByName) {
  const auto expectRefused = [](const std::vector<DesignElement>& elements, const std::vector<std::string>& parts) {
    test::expectFault<InputError>([&] { findJunctions(elements, 0.01); }, parts);
  };
  std::vector<DesignElement> elements = mergeOfTwo();
  elements.push_back(moving("north", {0.5, 1, 0}, kMeeting, 0.0, 0.6));
  expectRefused(elements, {"\"west\"", "\"east\"", "\"north\"", "\"one\"", "0.6"});
  elements = mergeOfTwo();
  elements[1].kind = SingularKind::Saddle;
  expectRefused(elements, {"saddle \"east\"", "\"west\""});
  elements = mergeOfTwo();
  elements[1].kind = SingularKind::VortexCw;
  expectRefused(elements, {"\"west\"", "\"east\"", "opposite"});
}

}  // namespace
}  // namespace stormfield
