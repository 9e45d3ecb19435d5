// Tracking over lambda beside what any method by frames must do at least: find the fixed points of every sample (and
// then guess which belong together).
#include <benchmark/benchmark.h>

#include "../tracking/tracked_fields.h"
#include "fixtures.h"
#include "topology/fixed_points.h"
#include "tracking/tracking.h"

namespace stormfield {
namespace {

/// 100 samples on a sphere with 10 n^2 + 2 vertices: smooth (two random quadratic maps blended through a third) or as
/// rough as fields of weather, a random field averaged over its neighbours and moved on a circle.
ParameterizedField history(Index n, bool rough) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(n));
  if (!rough) return test::smoothBlend(charts, 100, 3);
  const TriangleMesh& mesh = charts->mesh();
  const auto averaged = [&](std::uint64_t seed) {
    std::vector<Complex> values = test::randomField(charts, seed).values;
    for (int round = 0; round < 20; ++round) {
      std::vector<Complex> next = values;
      for (Index h = 0; h < mesh.halfedgeCount(); ++h)
        next[mesh.head(h)] += charts->transport(h) * values[mesh.tail(h)];
      values = std::move(next);
      for (Complex& value : values) value /= 4.0;
    }
    return values;
  };
  const std::vector<Complex> a = averaged(1), b = averaged(2);
  ParameterizedField field{charts, evenLambdas(100), {}};
  std::vector<Complex> values;
  for (const double lambda : field.lambdas) {
    for (std::size_t v = 0; v < a.size(); ++v) {
      values.push_back(std::cos(6.0 * lambda) * a[v] + std::sin(6.0 * lambda) * b[v]);
    }
  }
  field.values = values;
  return field;
}

void Tracking(benchmark::State& state) {
  const ParameterizedField field = history(static_cast<Index>(state.range(0)), state.range(1) != 0);
  stormfield::Tracking tracking;
  for (auto _ : state) {
    Progress progress;
    tracking = trackFixedPoints(field, {}, progress);
  }
  double samples = 0.0;
  for (const TrackedPath& path : tracking.paths) samples += static_cast<double>(path.samples.size());
  state.counters["vertices"] = field.vertexCount();
  state.counters["paths"] = static_cast<double>(tracking.paths.size());
  state.counters["bifurcations"] = static_cast<double>(tracking.bifurcations.size());
  state.counters["samples"] = samples;
}

void FixedPointsOfEverySample(benchmark::State& state) {
  const ParameterizedField field = history(static_cast<Index>(state.range(0)), state.range(1) != 0);
  double found = 0.0;
  for (auto _ : state) {
    found = 0.0;
    for (Index j = 0; j < field.sampleCount(); ++j) {
      found += static_cast<double>(findFixedPoints(sampleField(field, j)).size());
    }
  }
  state.counters["fixed points"] = found;
}

BENCHMARK(Tracking)
    ->ArgsProduct({{45}, {0, 1}})
    ->ArgNames({"n", "rough"})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();
BENCHMARK(FixedPointsOfEverySample)
    ->ArgsProduct({{45}, {0, 1}})
    ->ArgNames({"n", "rough"})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace stormfield
