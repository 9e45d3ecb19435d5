// Constraints sorted into rows: merged, or refused by name.
#include "solver/detail/constraint_rows.h"

#include <gtest/gtest.h>

#include <limits>

#include "checks.h"

namespace stormfield {
namespace {

constexpr double kHard = std::numeric_limits<double>::infinity();
const std::vector<Index> kRowOf = {2, kNone, 0, 1};  // of four vertices, one of them loose
const std::vector<double> kMass = {0.5, 0.3, 0.2};

ConstraintSet oneConstraint() {
  ConstraintSet set;
  set.elementNames = {"eye"};
  set.add(0, 1, {1.0, 2.0}, 4.0, 0);
  return set;
}

ConstraintRows rowsOf(const ConstraintSet& set) {
  return constraintRows(set, kRowOf, kMass, 5);
}

TEST(ConstraintRows, AddUpSoftOnesAndLetHardOnesWin) {
  ConstraintSet set = oneConstraint();
  set.add(0, 1, {3.0, 0.0}, 1.0, 0);    // the same place, soft
  set.add(0, 0, {0.0, 1.0}, 2.0, 0);    // an earlier sample
  set.add(2, 3, {5.0, 0.0}, 7.0, 0);    // soft beside hard
  set.add(2, 3, {1.0, 1.0}, kHard, 0);  // hard
  set.add(2, 3, {1.0, 1.0}, kHard, 0);  // the same again
  set.add(1, 0, {9.0, 9.0}, 1.0, 0);    // on a loose vertex: without effect
  const ConstraintRows rows = rowsOf(set);
  EXPECT_TRUE(rows.anyHard);
  ASSERT_EQ(rows.end(2) - rows.begin(2), 2);
  EXPECT_EQ(rows.begin(2)[0], (ConstraintRows::Entry{0, 2.0 * 0.2, 2.0 * 0.2 * Complex(0.0, 1.0)}));
  EXPECT_EQ(rows.begin(2)[1].sample, 1);
  EXPECT_DOUBLE_EQ(rows.begin(2)[1].weight, 5.0 * 0.2);
  test::expectNear(rows.begin(2)[1].pull, 0.2 * Complex(4.0 * 1.0 + 3.0, 4.0 * 2.0), 1e-15);
  ASSERT_EQ(rows.end(0) - rows.begin(0), 1);
  EXPECT_TRUE(rows.begin(0)->hard());
  EXPECT_EQ(rows.begin(0)->pull, Complex(1.0, 1.0));
  EXPECT_EQ(rows.begin(1), rows.end(1));
}

TEST(ConstraintRows, AreTheSameForAnyOrderOfTheirPlaces) {
  ConstraintSet set, reversed;
  set.elementNames = reversed.elementNames = {"eye"};
  for (Index k = 0; k < 15; ++k) set.add(k % 3 == 1 ? 3 : k % 3, k / 3, {1.0 * k, 1.0}, 1.0 + k, 0);
  for (Index k = 15; k-- > 0;) {
    reversed.add(set.vertex[k], set.sample[k], set.value[k], set.weight[k], set.element[k]);
  }
  const ConstraintRows a = rowsOf(set), b = rowsOf(reversed);
  for (Index row = 0; row < 3; ++row) EXPECT_TRUE(a.sameRow(row, b)) << row;
}

TEST(ConstraintRows, RefuseBadInputByName) {
  const auto expectRefused = [](const ConstraintSet& set, const std::vector<std::string>& parts) {
    test::expectFault<InputError>([&] { rowsOf(set); }, parts);
  };
  expectRefused({}, {"no constraint"});
  ConstraintSet set = oneConstraint();
  set.weight.clear();
  expectRefused(set, {"same length"});
  set = oneConstraint();
  set.vertex[0] = 4;
  expectRefused(set, {"element 'eye'", "constraint 0", "vertex 4", "0 to 3"});
  set.vertex[0] = -1;
  expectRefused(set, {"vertex -1"});
  set = oneConstraint();
  set.sample[0] = 5;
  expectRefused(set, {"'eye'", "sample 5", "0 to 4"});
  set = oneConstraint();
  set.value[0] = {std::numeric_limits<double>::quiet_NaN(), 0.0};
  expectRefused(set, {"'eye'", "vertex 0", "not finite"});
  for (const double weight : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    set = oneConstraint();
    set.weight[0] = weight;
    expectRefused(set, {"'eye'", "weight", "above zero"});
  }
}

TEST(ConstraintRows, RefuseHardValuesThatContradict) {
  ConstraintSet set;
  set.elementNames = {"eye", "jet"};
  set.add(3, 2, {1.0, 0.0}, kHard, 0);
  set.add(3, 1, {0.0, 1.0}, kHard, 0);
  set.add(3, 2, {0.0, 1.0}, kHard, 1);
  test::expectFault<InputError>([&] { rowsOf(set); }, {"'eye'", "'jet'", "vertex 3", "lambda 0.5", "sample 2"});
  set.value[2] = Complex(1.0, 1e-12);  // but for round-off the same
  EXPECT_NO_THROW(rowsOf(set));
}

}  // namespace
}  // namespace stormfield
