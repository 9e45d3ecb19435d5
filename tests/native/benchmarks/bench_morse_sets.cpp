// Morse sets of a geometry-based map by size of the mesh (times per face show the growth), what their persistence adds,
// and what one step of the slider over the error costs beside a new analysis.
#include <benchmark/benchmark.h>

#include <random>

#include "../tracing/surfaces.h"
#include "morse/morse_analysis.h"

namespace stormfield {
namespace {

/// A swirl with errors: hundreds of sets.
VectorField roughField(const std::shared_ptr<const VertexCharts>& charts) {
  VectorField field = surfaces::swirlField(charts);
  std::mt19937_64 random(1);
  for (Complex& value : field.values) {
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 - 0.5; };
    const double x = uniform(), y = uniform();
    value += 0.5 * Complex(x, y);
  }
  return field;
}

void report(benchmark::State& state, const VectorField& field, const MorseAnalysis& analysis) {
  state.counters["faces"] = field.mesh().faceCount();
  state.counters["sets"] = analysis.decomposition.faces.count();
  state.counters["s/1e6 faces"] = benchmark::Counter(
      1e-6 * field.mesh().faceCount(), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void MorseSets(benchmark::State& state) {
  const auto charts = surfaces::sphere(static_cast<Index>(state.range(0)));
  const VectorField field = roughField(charts);
  MorseAnalysisOptions options;
  options.persistence = state.range(1) != 0;
  Progress progress;
  MorseAnalysis analysis;
  for (auto _ : state) analysis = analyzeMorse(nullptr, field, options, progress);
  report(state, field, analysis);
}
BENCHMARK(MorseSets)
    ->ArgsProduct({{36, 72, 144}, {0, 1}})
    ->ArgNames({"n", "persistence"})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void SimplifiedMorseSets(benchmark::State& state) {
  const auto charts = surfaces::sphere(static_cast<Index>(state.range(0)));
  const VectorField field = roughField(charts);
  Progress progress;
  const MorseAnalysis full = analyzeMorse(nullptr, field, {}, progress);
  MorseAnalysis analysis;
  for (auto _ : state) analysis = within(full, 0.02, true, progress);
  report(state, field, analysis);
}
BENCHMARK(SimplifiedMorseSets)->Arg(72)->ArgName("n")->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stormfield
