#include "edit/simplify.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <iostream>
#include <limits>

#include "checks.h"
#include "data_sets.h"
#include "edited_fields.h"
#include "long_tests.h"
#include "maps/error_bound.h"

namespace stormfield::test {
namespace {

std::size_t entities(const Topology& topology) {
  return topology.fixedPoints.size() + topology.periodicOrbits.size();
}

SimplifyResult simplified(const VectorField& field, const SimplifyOptions& options) {
  const FlatFaces faces(field.charts);
  Progress progress;
  return simplifyField(faces, field, findTopology(faces, field), options, progress);
}

TEST(Simplify, KeepsAsManyAsAsked) {
  const VectorField field = smoothField(torus(48, 24), 1);
  const std::size_t before = entities(topologyOf(field));
  ASSERT_GE(before, 10u);
  const SimplifyResult result = simplified(field, {.keep = 6});
  EXPECT_LE(entities(result.topology), 6u);
  const Topology after = topologyOf(result.field);
  EXPECT_EQ(entities(after), entities(result.topology));
  EXPECT_EQ(indexSum(after), 0);
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    const bool changed = std::binary_search(result.vertices.begin(), result.vertices.end(), static_cast<Index>(v));
    EXPECT_EQ(changed, field.values[v] != result.field.values[v]);
  }
}

/// The sphere's two cannot go, and nothing that is asked for twice changes twice.
TEST(Simplify, EndsWhereNothingIsLeftToCancel) {
  const VectorField field = smoothField(icosphere(4), 1);
  const SimplifyResult result = simplified(field, {});
  EXPECT_EQ(indexSum(result.topology), 2);
  EXPECT_LE(entities(result.topology), 3u);
  const SimplifyResult again = simplified(result.field, {});
  EXPECT_EQ(again.field.values, result.field.values);
}

TEST(Simplify, ChangesByNoMoreThanEpsilon) {
  const VectorField field = smoothField(torus(48, 24), 1);
  std::size_t before = entities(topologyOf(field)) + 1;
  for (const double epsilon : {0.0, 0.3, 1.0, 3.0}) {
    const SimplifyResult result = simplified(field, {.epsilon = epsilon});
    EXPECT_LE(result.change.largest, epsilon * meanSpeed(field));
    EXPECT_LE(entities(result.topology), before);
    before = entities(result.topology);
    for (const SimplifyStep& step : result.steps) EXPECT_LE(step.persistence, epsilon);
  }
  EXPECT_LT(before, entities(topologyOf(field)));
}

TEST(Simplify, SameForAnyNumberOfThreads) {
  const VectorField field = smoothField(torus(32, 16), 1);
  const SimplifyResult many = simplified(field, {.keep = 8});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(many.field.values, simplified(field, {.keep = 8}).field.values);
}

TEST(Simplify, GasEngine) {
  const auto engine = dataSet("gasEngineV.t");
  if (!engine) GTEST_SKIP() << withoutDataSet("gasEngineV.t");
  if (!longTests()) GTEST_SKIP() << "a long test";
  const VectorField field = fieldOn(*engine);
  const SimplifyResult result = simplified(field, {.keep = 12});
  std::cout << entities(topologyOf(field)) << " entities to " << entities(result.topology) << " in "
            << result.steps.size() << " tries\n";
  EXPECT_LE(entities(result.topology), 20u);
}

TEST(Simplify, RefusesBadOptions) {
  const VectorField field = smoothField(icosphere(2), 1);
  expectFault<InputError>([&] { simplified(field, {.epsilon = -1.0}); }, {"epsilon is -1"});
  expectFault<InputError>([&] { simplified(field, {.epsilon = std::numeric_limits<double>::quiet_NaN()}); },
                          {"epsilon is"});
  expectFault<InputError>([&] { simplified(field, {.keep = -1}); }, {"keep is -1"});
}

}  // namespace
}  // namespace stormfield::test
