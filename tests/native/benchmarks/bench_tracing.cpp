// Edge crossings per second of the tracer, with its error against a fine trace of the same seeds, in mean edge lengths.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "../tracing/surfaces.h"
#include "tracing/pathline.h"
#include "tracing/streamline.h"

namespace stormfield {
namespace {

/// Streamlines of a fixed arc length on a sphere with range(0)^2 * 20 faces; range(1) is -log10 of the tolerance.
void Streamlines(benchmark::State& state) {
  const auto charts = surfaces::sphere(static_cast<Index>(state.range(0)));
  const VectorField field = surfaces::swirlField(charts);
  const FlatFaces faces(charts);
  const auto seeds = surfaces::randomSeeds(charts->mesh(), 2000, 1);
  TraceOptions options;
  options.maximalLength = 100.0 * charts->mesh().meanEdgeLength();
  options.tolerance = std::pow(10.0, -static_cast<double>(state.range(1)));

  const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
  double crossings = 0.0, steps = 0.0;
  std::vector<TraceEnd> ends(seeds.size());
  for (auto _ : state) {
    ends = traceStreamlineEnds(faces, field, seeds, options);
    for (const TraceEnd& end : ends) {
      crossings += end.crossings;
      steps += end.steps;
    }
  }
  TraceOptions fine = options;
  fine.tolerance = 1e-12;
  const auto exact = traceStreamlineEnds(faces, field, seeds, fine);
  std::vector<double> errors;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    errors.push_back((position(charts->mesh(), ends[i].point) - position(charts->mesh(), exact[i].point)).norm() /
                     charts->mesh().meanEdgeLength());
  }
  std::sort(errors.begin(), errors.end());
  state.counters["crossings/s"] = benchmark::Counter(crossings, benchmark::Counter::kIsRate);
  state.counters["steps/crossing"] = steps / crossings;
  state.counters["median error"] = errors[errors.size() / 2];
  state.counters["95% error"] = errors[errors.size() * 95 / 100];
}
BENCHMARK(Streamlines)
    ->ArgsProduct({{20, 72}, {3, 4, 5, 6, 8}})
    ->ArgNames({"n", "digits"})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stormfield
