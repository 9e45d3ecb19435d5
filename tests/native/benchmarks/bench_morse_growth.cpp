// How the time of Morse decompositions grows with the faces: exponents of processor time from one size to the next, for
// geometry-based sets with their graph, with persistence, for refinement inside faces, and for tau maps where every
// face leads to as many others (tau as the length of the edges) and at equal tau, where it leads to more and more.
// Those on the gas engine of the thesis are skipped without the data.
#include <benchmark/benchmark.h>

#include "data_sets.h"
#include "growth.h"
#include "maps/tau_map.h"
#include "morse/morse_analysis.h"
#include "morse/transit_refinement.h"
#include "rough_field.h"

namespace stormfield {
namespace {

void GeometrySetsGrowth(benchmark::State& state) {
  for (auto _ : state) {
    Growth plain, whole;
    for (const Index n : {36, 72, 144}) {
      const VectorField field = roughField(test::makeCharts(test::dividedIcosahedron(n)));
      const auto analyze = [&](bool persistence) {
        MorseAnalysisOptions options;
        options.persistence = persistence;
        Progress progress;
        analyzeMorse(nullptr, field, options, progress);
      };
      const double alone = processorTime(5, [&] { analyze(false); }), both = processorTime(5, [&] { analyze(true); });
      plain.add(field.mesh().faceCount(), alone);
      whole.add(field.mesh().faceCount(), both);
      state.counters["persistence / sets at n = " + std::to_string(n)] = both / alone - 1.0;
    }
    plain.report(state, "sets");
    whole.report(state, "with persistence");
  }
}
BENCHMARK(GeometrySetsGrowth)->Unit(benchmark::kSecond)->Iterations(1);

struct GasEngine {
  std::shared_ptr<const VectorField> field;
  std::shared_ptr<const FlatFaces> faces;

  /// Every edge cut in so many pieces.
  GasEngine(const test::SampledSurface& data, Index pieces)
      : field(std::make_shared<const VectorField>(test::fieldOn(test::subdivided(data, pieces)))),
        faces(std::make_shared<const FlatFaces>(field->charts)) {}

  double size() const { return field->mesh().faceCount(); }
};

void TransitRefinementGrowth(benchmark::State& state) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) return state.SkipWithError(test::withoutDataSet("gasEngineV.t").c_str());
  for (auto _ : state) {
    Growth time, nodes;
    for (const Index pieces : {1, 2, 4}) {
      const GasEngine engine(*data, pieces);
      double count = 0.0;
      time.add(engine.size(), processorTime(pieces < 4 ? 3 : 1, [&] {
                 TransitRefinement refinement(engine.faces, engine.field);
                 refinement.refine();
                 Progress progress;
                 benchmark::DoNotOptimize(refinement.decomposition(refinement.map().map(), {}, progress));
                 count = refinement.map().outside();
               }));
      nodes.add(engine.size(), count);
    }
    time.report(state, "time");
    nodes.report(state, "nodes");
  }
}
BENCHMARK(TransitRefinementGrowth)->Unit(benchmark::kSecond)->Iterations(1);

/// range(0): whether tau is proportional to the length of the edges.
void TauMapGrowth(benchmark::State& state) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) return state.SkipWithError(test::withoutDataSet("gasEngineV.t").c_str());
  constexpr double kTau = 6e-4;
  const bool asEdges = state.range(0) != 0;
  for (auto _ : state) {
    Growth time, traces, edges;
    for (const Index pieces : {1, 2, 3, 4}) {
      if (!asEdges && pieces > 3) continue;
      const GasEngine engine(*data, pieces);
      const double tau = asEdges ? kTau / pieces : kTau;
      TauWork work;
      std::size_t edgeCount = 0;
      time.add(engine.size(), processorTime(pieces < 3 ? 3 : 1, [&] {
                 work = {};
                 const CombinatorialMap map = tauMap(*engine.faces, *engine.field, tau, {}, nullptr, &work);
                 MorseOptions options;
                 options.mapped.assign(engine.field->mesh().faceCount(), 1);
                 Progress progress;
                 edgeCount = morseDecomposition(*engine.field, map, options, progress).mapEdges;
               }));
      traces.add(engine.size(), static_cast<double>(work.traces));
      edges.add(engine.size(), static_cast<double>(edgeCount));
    }
    time.report(state, "time");
    traces.report(state, "traces");
    edges.report(state, "edges of F");
  }
}
BENCHMARK(TauMapGrowth)->Arg(1)->Arg(0)->ArgName("tau as edges")->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace stormfield
