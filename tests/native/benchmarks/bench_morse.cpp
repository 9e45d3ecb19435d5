// Tau maps and hierarchical refinement on the thesis's gas engine (tables 7.1, 8.1): edges of F, Morse sets, bytes per
// edge at the peak, and how time grows with the faces (the field subdivided at the same tau). The largest has more than
// the 221,574 faces of the thesis's diesel engine, which is not at hand. Skipped without the data.
#include <benchmark/benchmark.h>

#include "data_sets.h"
#include "morse/tau_refinement.h"

namespace stormfield {
namespace {

/// range(0): pieces that every edge is cut in; range(1): tau in 1e-4 s.
void TauMapOfGasEngine(benchmark::State& state) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) return state.SkipWithError(test::withoutDataSet("gasEngineV.t").c_str());
  const VectorField field = test::fieldOn(test::subdivided(*data, static_cast<Index>(state.range(0))));
  const FlatFaces faces(field.charts);
  const double tau = static_cast<double>(state.range(1)) * 1e-4;
  TauWork work;
  MorseDecomposition morse;
  for (auto _ : state) {
    work = {};
    const CombinatorialMap map = tauMap(faces, field, tau, {}, nullptr, &work);
    MorseOptions options;
    options.mapped.assign(field.mesh().faceCount(), 1);
    Progress progress;
    morse = morseDecomposition(field, map, options, progress);
  }
  state.counters["faces"] = field.mesh().faceCount();
  state.counters["edges of F"] = static_cast<double>(morse.mapEdges);
  state.counters["edges per face"] = static_cast<double>(morse.mapEdges) / field.mesh().faceCount();
  state.counters["bytes per edge"] = static_cast<double>(work.peakBytes) / static_cast<double>(morse.mapEdges);
  state.counters["traces"] = static_cast<double>(work.traces);
  state.counters["sets"] = morse.faces.count();
}
BENCHMARK(TauMapOfGasEngine)
    ->Args({1, 3})
    ->Args({1, 6})
    ->Args({1, 10})
    ->Args({2, 6})
    ->Args({3, 6})
    ->ArgNames({"pieces", "tau/1e-4"})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Iterations(1);

void RefinementOfGasEngine(benchmark::State& state) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) return state.SkipWithError(test::withoutDataSet("gasEngineV.t").c_str());
  const auto field = std::make_shared<const VectorField>(test::fieldOn(*data));
  const auto faces = std::make_shared<const FlatFaces>(field->charts);
  TauRefinementOptions options;
  options.edgesMax = static_cast<double>(state.range(0));
  for (auto _ : state) {
    TauRefinement refinement(faces, field, options);
    refinement.refine();
    state.counters["sets"] = refinement.sets().count();
    state.counters["steps"] = refinement.steps();
    state.counters["traces"] = static_cast<double>(refinement.traces());
  }
}
BENCHMARK(RefinementOfGasEngine)
    ->Arg(32)
    ->Arg(128)
    ->ArgName("edges")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Iterations(1);

}  // namespace
}  // namespace stormfield
