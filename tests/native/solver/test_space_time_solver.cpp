#include "solver/space_time_solver.h"

#include <tbb/global_control.h>

#include "long_tests.h"
#include "polls.h"
#include "solver/solver_checks.h"
#include "solver/storm_constraints.h"

namespace stormfield {
namespace {

using namespace solving;

TEST(SpaceTimeSolver, LeavesComponentsWithoutConstraintAtZero) {
  const auto sphere = test::makeCharts(test::dividedIcosahedron(3));
  const ChartsPointer charts = together({sphere, annulus(12, 3), test::makeCharts(test::torus(10, 6))});
  const Index first = sphere->mesh().vertexCount();
  ConstraintSet constraints;
  constraints.elementNames = {"ring"};
  constraints.add(first + 2, 3, Complex(1, 1), 50.0, 0);
  SpaceTimeOptions options;
  options.samples = 9;
  Progress progress;
  ParameterizedField start{charts, {}, std::vector<Complex>(9 * charts->mesh().vertexCount(), Complex(1, 2))};
  for (int j = 0; j < 9; ++j) start.lambdas.push_back(j / 8.0);
  const SpaceTimeSolver solver(charts, options);
  SpaceTimeState cold, warm = solver.startFrom(start);
  for (SpaceTimeState* state : {&cold, &warm}) {
    const SpaceTimeResult result = solver.solve(constraints, progress, *state);
    EXPECT_EQ(result.componentsWithoutConstraint, (std::vector<Index>{0, 2}));
    for (Index j = 0; j < 9; ++j) {
      for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
        const bool zero = result.field.sample(j)[v] == Complex{};
        EXPECT_EQ(zero, charts->mesh().component(v) != 1) << v;
      }
    }
  }
}

TEST(SpaceTimeSolver, GivesTheSameBitsForAnyThreadCount) {
  const ChartsPointer sphere = test::makeCharts(test::dividedIcosahedron(16));
  const ConstraintSet constraints = storms::storms(*sphere, {.samples = 30});
  auto solve = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Progress progress;
    return SpaceTimeSolver(sphere, {.samples = 30}).solve(constraints, progress).field.values;
  };
  const FieldValues one = solve(1);
  EXPECT_EQ(one, solve(2));
  EXPECT_EQ(one, solve(3));
}

TEST(SpaceTimeSolver, StopsSoonAfterCancel) {
  const ChartsPointer sphere = test::makeCharts(test::dividedIcosahedron(test::shortOrLong(24, 40)));
  SpaceTimeOptions options;
  options.tolerance = 1e-12;
  const SpaceTimeSolver solver(sphere, options);
  const ConstraintSet constraints = storms::storms(*sphere, {});
  test::expectStopsSoon([&](Progress& progress) { solver.solve(constraints, progress); }, 5000, 0.6);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(SpaceTimeSolver(sphere, options, progress), Cancelled);
}

TEST(SpaceTimeSolver, NamesWhatIsWrongWithConstraints) {
  const ChartsPointer cube = test::makeCharts(test::cube());
  const SpaceTimeSolver solver(cube, {.samples = 5});
  auto messageOf = [&](const ConstraintSet& constraints) -> std::string {
    Progress progress;
    try {
      solver.solve(constraints, progress);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  auto one = [&](Index v, Index j, Complex value, double weight) {
    ConstraintSet set;
    set.elementNames = {"west storm", "east storm"};
    set.add(v, j, value, weight, 1);
    return set;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(messageOf({}).find("no constraint"), std::string::npos);
  for (const ConstraintSet& bad :
       {one(8, 0, 1.0, 1.0), one(-1, 0, 1.0, 1.0), one(0, 5, 1.0, 1.0), one(0, -1, 1.0, 1.0), one(0, 0, nan, 1.0),
        one(0, 0, 1.0, 0.0), one(0, 0, 1.0, -2.0), one(0, 0, 1.0, nan)}) {
    EXPECT_NE(messageOf(bad).find("east storm"), std::string::npos) << messageOf(bad);
  }
  ConstraintSet contradiction = one(3, 1, Complex(1, 0), kHard);
  contradiction.add(3, 1, Complex(1, 0), kHard, 0);
  EXPECT_EQ(messageOf(contradiction), "accepted");
  contradiction.add(3, 1, Complex(0, 1), kHard, 0);
  const std::string text = messageOf(contradiction);
  for (const char* part : {"west storm", "vertex 3", "lambda 0.25"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  ConstraintSet both = one(3, 1, Complex(0, 1), kHard);
  both.add(3, 2, Complex(1, 0), kHard, 0);
  both.add(3, 1, Complex(9, 9), 10.0, 0);  // a hard value beats a soft one
  EXPECT_EQ(messageOf(both), "accepted");
  ConstraintSet pair = one(3, 1, Complex(1, 0), kHard);
  pair.add(3, 1, Complex(-1, 0), kHard, 0);
  for (const char* part : {"west storm", "east storm"}) EXPECT_NE(messageOf(pair).find(part), std::string::npos);
}

TEST(SpaceTimeSolver, RefusesConstraintsOnLooseVerticesOnly) {
  const ChartsPointer charts = together({test::makeCharts(test::dividedIcosahedron(3))});
  ConstraintSet constraints;
  constraints.add(charts->mesh().vertexCount() - 1, 0, 1.0, 10.0, 0);
  Progress progress;
  const SpaceTimeSolver solver(charts, {.samples = 4});
  EXPECT_THROW(solver.solve(constraints, progress), InputError);
  constraints.add(0, 0, 1.0, 10.0, 0);
  const SpaceTimeResult result = solver.solve(constraints, progress);
  EXPECT_EQ(result.field.sample(2)[charts->mesh().vertexCount() - 1], Complex{});
  EXPECT_NE(result.field.sample(2)[0], Complex{});
}

TEST(SpaceTimeSolver, RefusesOptionsAndStartsThatDoNotFit) {
  const ChartsPointer cube = test::makeCharts(test::cube());
  EXPECT_THROW(SpaceTimeSolver(cube, {.samples = 0}), InputError);
  EXPECT_THROW(SpaceTimeSolver(cube, {.lambdaWeight = 0.0}), InputError);
  EXPECT_THROW(SpaceTimeSolver(cube, {.tolerance = 0.0}), InputError);
  EXPECT_THROW(SpaceTimeSolver(cube, {.accuracy = 1e-6}), InputError);
  EXPECT_THROW(SpaceTimeSolver(cube, {.maxIterations = 0}), InputError);
  ConstraintSet constraints;
  constraints.add(0, 0, 1.0, 1.0, 0);
  Progress progress;
  const ParameterizedField wrong{cube, {0.0, 1.0}, std::vector<Complex>(16)};
  EXPECT_THROW(SpaceTimeSolver(cube, {.samples = 3}).startFrom(wrong), InputError);
  ParameterizedField broken = SpaceTimeSolver(cube, {.samples = 3}).solve(constraints, progress).field;
  broken.values[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SpaceTimeSolver(cube, {.samples = 3}).startFrom(broken), InputError);
  SpaceTimeOptions hopeless{.samples = 100, .tolerance = 1e-17};
  EXPECT_THROW(SpaceTimeSolver(test::makeCharts(test::dividedIcosahedron(5)), hopeless).solve(constraints, progress),
               SolverError);
  const SpaceTimeOptions hasty{.samples = 100, .maxIterations = 1};
  EXPECT_THROW(SpaceTimeSolver(test::makeCharts(test::dividedIcosahedron(5)), hasty).solve(constraints, progress),
               SolverError);
}

}  // namespace
}  // namespace stormfield
