#include "solver/solver_checks.h"
#include "solver/storm_constraints.h"

namespace stormfield {
namespace {

using namespace solving;

TEST(SpaceTimeSolver, WarmStartReachesTheSameFieldInFewerSteps) {
  const ChartsPointer sphere = test::makeCharts(test::dividedIcosahedron(12));
  SpaceTimeOptions options;
  options.samples = 40;
  const SpaceTimeSolver solver(sphere, options);
  storms::StormOptions storm;
  storm.samples = 40;
  Progress progress;
  SpaceTimeState kept;
  const SpaceTimeResult before = solver.solve(storms::storms(*sphere, storm), progress, kept);
  SpaceTimeState fromField = solver.startFrom(before.field);
  const SpaceTimeResult same = solver.solve(storms::storms(*sphere, storm), progress, kept);
  EXPECT_EQ(same.iterations, 0);
  EXPECT_EQ(same.error, before.error);
  EXPECT_EQ(same.field.values, before.field.values);
  const SpaceTimeSolver precise(sphere, {.samples = 40, .tolerance = 1e-6});
  SpaceTimeState preciseState;
  const SpaceTimeResult once = precise.solve(storms::storms(*sphere, storm), progress, preciseState);
  const SpaceTimeResult twice = precise.solve(storms::storms(*sphere, storm), progress, preciseState);
  EXPECT_LT(difference(twice.field.values, once.field.values), 1e-5);
  // What another field is to these constraints only a step can tell.
  const SpaceTimeResult again = solver.solve(storms::storms(*sphere, storm), progress, fromField);
  EXPECT_EQ(again.iterations, 1);
  EXPECT_LT(difference(again.field.values, before.field.values), 2e-3);
  storm.shift = 0.05;
  const SpaceTimeResult cold = solver.solve(storms::storms(*sphere, storm), progress);
  for (SpaceTimeState* state : {&kept, &fromField}) {
    const SpaceTimeResult warm = solver.solve(storms::storms(*sphere, storm), progress, *state);
    EXPECT_LT(warm.iterations, cold.iterations);
    EXPECT_LE(warm.residual, options.tolerance);
    EXPECT_LT(difference(warm.field.values, cold.field.values), 2e-3);
  }
}

/// Of fields on one mesh, relative, in the mean square over surface and lambda.
double meanDifference(const ParameterizedField& a, const ParameterizedField& b) {
  const TriangleMesh& mesh = a.charts->mesh();
  double difference = 0.0, length = 0.0;
  for (Index j = 0; j < a.sampleCount(); ++j) {
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      difference += mesh.vertexArea(v) * std::norm(a.sample(j)[v] - b.sample(j)[v]);
      length += mesh.vertexArea(v) * std::norm(b.sample(j)[v]);
    }
  }
  return std::sqrt(difference / length);
}

TEST(SpaceTimeSolver, FieldsAreAsCloseToTheExactOnesAsTheySay) {
  // Heavy constraints and light ones, edits small and large: a residual within the tolerance would not be enough.
  for (const auto& charts :
       {test::makeCharts(test::dividedIcosahedron(10)), test::makeCharts(test::torus(28, 13, 1.0, 0.4, 0.2))}) {
    for (const double weight : {1e3, 4e5}) {
      const SpaceTimeSolver solver(charts, {.samples = 30}), exactly(charts, {.samples = 30, .tolerance = 1e-10});
      SpaceTimeState state, exactState;
      Progress progress;
      for (const double shift : {0.0, 0.003, 0.08}) {
        SCOPED_TRACE(testing::Message() << charts->mesh().vertexCount() << " vertices, weight " << weight << ", shift "
                                        << shift);
        const ConstraintSet constraints =
            storms::storms(*charts, {.samples = 30, .radius = 0.2, .weight = weight, .shift = shift});
        const SpaceTimeResult result = solver.solve(constraints, progress, state);
        const double error = meanDifference(result.field, exactly.solve(constraints, progress, exactState).field);
        EXPECT_LT(error, solver.options().accuracy);
        EXPECT_LE(result.error, solver.options().accuracy);
        EXPECT_GT(result.error, 0.5 * error);
        EXPECT_LE(result.residual, solver.options().tolerance);
      }
    }
  }
}

TEST(SpaceTimeSolver, SmallEditsDoNotAddUp) {
  // Each of them moves the storm by less than the tolerance sees.
  const ChartsPointer sphere = test::makeCharts(test::dividedIcosahedron(10));
  const SpaceTimeSolver solver(sphere, {.samples = 20, .tolerance = 0.1}), exactly(sphere, {.samples = 20});
  SpaceTimeState state;
  Progress progress;
  storms::StormOptions storm{.samples = 20};
  for (int edit = 0; edit <= 20; ++edit) {
    storm.shift = 0.005 * edit;
    const SpaceTimeResult result = solver.solve(storms::storms(*sphere, storm), progress, state);
    if (edit % 10 != 0) continue;
    const SpaceTimeResult exact = exactly.solve(storms::storms(*sphere, storm), progress);
    EXPECT_LT(meanDifference(result.field, exact.field), solver.options().accuracy);
  }
}

TEST(SpaceTimeSolver, StateOutlivesACancelledSolveAndKnowsItsSolver) {
  const ChartsPointer sphere = test::makeCharts(test::dividedIcosahedron(8));
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
