#include "solver/solver_checks.h"
#include "solver/storm_constraints.h"

namespace stormfield {
namespace {

using namespace solving;

TEST(SpaceTimeSolver, WarmStartReachesTheSameFieldInFewerSteps) {
  const ChartsPointer sphere = surfaces::sphere(12);
  SpaceTimeOptions options;
  options.samples = 40;
  const SpaceTimeSolver solver(sphere, options);
  storms::StormOptions storm;
  storm.samples = 40;
  Progress progress;
  SpaceTimeState kept;
  const SpaceTimeResult before = solver.solve(storms::storms(*sphere, storm), progress, kept);
  SpaceTimeState fromField = solver.startFrom(before.field);
  for (SpaceTimeState* state : {&kept, &fromField}) {
    const SpaceTimeResult same = solver.solve(storms::storms(*sphere, storm), progress, *state);
    EXPECT_EQ(same.iterations, 0);
    EXPECT_EQ(same.field.values, before.field.values);
  }
  storm.shift = 0.05;
  const SpaceTimeResult cold = solver.solve(storms::storms(*sphere, storm), progress);
  for (SpaceTimeState* state : {&kept, &fromField}) {
    const SpaceTimeResult warm = solver.solve(storms::storms(*sphere, storm), progress, *state);
    EXPECT_LT(warm.iterations, cold.iterations);
    EXPECT_LE(warm.residual, options.tolerance);
    EXPECT_LT(difference(warm.field.values, cold.field.values), 2e-3);
  }
}

TEST(SpaceTimeSolver, StateOutlivesACancelledSolveAndKnowsItsSolver) {
  const ChartsPointer sphere = surfaces::sphere(8);
  const SpaceTimeSolver solver(sphere, {.samples = 20});
  const ConstraintSet before = storms::storms(*sphere, {.samples = 20});
  const ConstraintSet after = storms::storms(*sphere, {.samples = 20, .shift = 0.1});
  Progress progress, cancelled;
  cancelled.cancel();
  SpaceTimeState state;
  solver.solve(before, progress, state);
  EXPECT_THROW(solver.solve(after, cancelled, state), Cancelled);
  const SpaceTimeResult result = solver.solve(after, progress, state);
  EXPECT_LE(result.residual, 1e-4);
  EXPECT_LT(difference(result.field.values, solver.solve(after, progress).field.values), 2e-3);
  EXPECT_THROW(SpaceTimeSolver(sphere, {.samples = 20}).solve(after, progress, state), InputError);
}

}  // namespace
}  // namespace stormfield
