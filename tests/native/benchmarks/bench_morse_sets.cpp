// Morse sets of a geometry-based map by size of the mesh (times per face show the growth), what their persistence adds,
// and what one step of the slider over the error costs beside a new analysis.
#include <benchmark/benchmark.h>

#include "morse/morse_analysis.h"
#include "rough_field.h"

namespace stormfield {
namespace {

void report(benchmark::State& state, const VectorField& field, const MorseAnalysis& analysis) {
  state.counters["faces"] = field.mesh().faceCount();
  state.counters["sets"] = analysis.decomposition.faces.count();
  state.counters["s/1e6 faces"] = benchmark::Counter(
      1e-6 * field.mesh().faceCount(), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void MorseSets(benchmark::State& state) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(static_cast<Index>(state.range(0))));
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
  const auto charts = test::makeCharts(test::dividedIcosahedron(static_cast<Index>(state.range(0))));
  const VectorField field = roughField(charts);
  Progress progress;
  const MorseAnalysis full = analyzeMorse(nullptr, field, {}, progress);
  MorseAnalysis analysis;
  for (auto _ : state) analysis = withinEpsilon(full, 0.02, full.kept, progress);
  report(state, field, analysis);
}
BENCHMARK(SimplifiedMorseSets)->Arg(72)->ArgName("n")->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stormfield
