// Edge crossings per second of the tracer, with its error against a fine trace of the same seeds, in mean edge lengths;
// frames of advected coordinates and stream functions per second.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "../tracing/surfaces.h"
#include "texture/advected_coordinates.h"
#include "texture/stagger.h"
#include "texture/stream_function.h"
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
    // Where a trace ends near a fixed point says how slow is slow enough, not how exact the way there is.
    if (ends[i].reason != StopReason::Length || exact[i].reason != StopReason::Length) continue;
    errors.push_back((position(charts->mesh(), ends[i].point) - position(charts->mesh(), exact[i].point)).norm() /
                     charts->mesh().meanEdgeLength());
  }
  std::sort(errors.begin(), errors.end());
  state.counters["crossings/s"] = benchmark::Counter(crossings, benchmark::Counter::kIsRate);
  state.counters["steps/crossing"] = steps / crossings;
  state.counters["median error"] = errors[errors.size() / 2];
  state.counters["95% error"] = errors[errors.size() * 95 / 100];
  state.counters["largest error"] = errors.back();
}
BENCHMARK(Streamlines)
    ->ArgsProduct({{20, 72}, {3, 4, 5, 6, 8}})
    ->ArgNames({"n", "digits"})
    ->Unit(benchmark::kMillisecond);

/// One frame of advected coordinates, both phases of a period of 48 frames, on a sphere with 10 range(0)^2 + 2 vertices
/// and 100 lambda samples, with every core. The errors are those of the carried coordinates, in mean edge lengths.
void AdvectedFrame(benchmark::State& state) {
  const auto charts = surfaces::sphere(static_cast<Index>(state.range(0)));
  auto field = std::make_shared<ParameterizedField>(ParameterizedField{charts, {}, {}});
  std::vector<Complex> values;
  for (int j = 0; j < 100; ++j) {
    const VectorField sample = surfaces::swirlField(charts, 0.03 * j);
    field->lambdas.push_back(j / 99.0);
    values.insert(values.end(), sample.values.begin(), sample.values.end());
  }
  field->values = values;
  std::vector<double> frames, lambdas;
  for (int f = 0; f <= 250; ++f) {
    frames.push_back(f);
    lambdas.push_back(0.5 - 0.5 * std::cos(std::numbers::pi * f / 250.0));
  }
  const AdvectionOptions options{.speed = 0.3};
  const AdvectedCoordinates coordinates(std::make_shared<FlatFaces>(charts), field, frames, lambdas, options,
                                        stagger(charts->mesh(), {}, options.deadZone));
  for (auto _ : state) benchmark::DoNotOptimize(coordinates.frame(120.0));
  const CarriedError error = coordinates.error(120.0);
  state.counters["mean error"] = error.mean;
  state.counters["largest error"] = error.largest;
  state.counters["mean error between vertices"] = error.meanBetween;
}
BENCHMARK(AdvectedFrame)->Arg(45)->ArgName("n")->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

/// Stream functions of 100 samples: one factorization, 100 solves.
void StreamFunctions(benchmark::State& state) {
  const auto charts = surfaces::sphere(static_cast<Index>(state.range(0)));
  ParameterizedField field{charts, {}, {}};
  std::vector<Complex> values;
  const VectorField sample = surfaces::swirlField(charts);
  for (int j = 0; j < 100; ++j) {
    field.lambdas.push_back(j / 99.0);
    values.insert(values.end(), sample.values.begin(), sample.values.end());
  }
  field.values = values;
  for (auto _ : state) benchmark::DoNotOptimize(streamFunctions(field));
}
BENCHMARK(StreamFunctions)->Arg(45)->ArgName("n")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace stormfield
