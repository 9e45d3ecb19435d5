// Edge crossings per second of the tracer (of processor time, one core), with its error against a fine trace of the
// same seeds, in mean edge lengths, where digits is -log10 of the tolerance and points says whether they are kept;
// frames of advected coordinates and stream functions per second.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "data_sets.h"
#include "fixtures.h"
#include "growth.h"
#include "mesh/morton_order.h"
#include "texture/advected_coordinates.h"
#include "texture/stagger.h"
#include "texture/stream_function.h"
#include "tracing/arrivals.h"
#include "tracing/streamline.h"

namespace stormfield {
namespace {

/// What is asked of streamlines: for where they end alone, or for all points as well.
enum Kept : std::int64_t { kEnds, kPoints };

/// Seeds whose streamlines have the whole length.
std::vector<SurfacePoint> seedsOfWholeLines(const FlatFaces& faces, const VectorField& field,
                                            const TraceOptions& options) {
  auto seeds = test::randomSeeds(faces.mesh(), 24000, 1);
  const auto ends = traceStreamlineEnds(faces, field, seeds, options);
  std::vector<SurfacePoint> whole;
  for (std::size_t i = 0; i < seeds.size() && whole.size() < 2000; ++i) {
    if (ends[i].reason == StopReason::Length) whole.push_back(seeds[i]);
  }
  return whole;
}

/// Streamlines 100 mean edges long, on one core, and the distances of their ends from those of fine traces.
void follow(benchmark::State& state, const VectorField& field, std::int64_t kept, std::int64_t digits) {
  const TriangleMesh& mesh = field.mesh();
  const FlatFaces faces(field.charts);
  TraceOptions options;
  options.maxLength = 100.0 * mesh.meanEdgeLength();
  options.minSpeed = 1e-9;
  const auto seeds = seedsOfWholeLines(faces, field, options);
  options.tolerance = std::pow(10.0, -static_cast<double>(digits));

  double crossings = 0.0, steps = 0.0;
  std::vector<TraceEnd> ends;
  {
    const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    for (auto _ : state) {
      if (kept == kPoints) {
        const Traces traces = traceStreamlines(faces, field, seeds, options);
        benchmark::DoNotOptimize(traces.points.data());
        ends = traces.ends;
      } else {
        ends = traceStreamlineEnds(faces, field, seeds, options);
      }
      for (const TraceEnd& end : ends) {
        crossings += end.crossings;
        steps += end.steps;
      }
    }
  }
  constexpr std::size_t kCompared = 200;
  options.tolerance = 1e-12;
  const auto exact =
      traceStreamlineEnds(faces, field, {seeds.begin(), seeds.begin() + std::min(kCompared, seeds.size())}, options);
  std::vector<double> errors;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    // Where a trace ends near a fixed point says how slow is slow enough, not how exact the way there is.
    if (ends[i].reason != StopReason::Length || exact[i].reason != StopReason::Length) continue;
    errors.push_back((position(mesh, ends[i].point) - position(mesh, exact[i].point)).norm() / mesh.meanEdgeLength());
  }
  std::sort(errors.begin(), errors.end());
  state.counters["crossings/s"] = benchmark::Counter(crossings, benchmark::Counter::kIsRate);
  state.counters["steps/crossing"] = steps / crossings;
  state.counters["median error"] = errors[errors.size() / 2];
  state.counters["95% error"] = errors[errors.size() * 95 / 100];
  state.counters["largest error"] = errors.back();
}

/// On a sphere with range(0)^2 * 20 faces.
void StreamlinesOnTheSphere(benchmark::State& state) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(static_cast<Index>(state.range(0))));
  follow(state, sampled(charts, analytic::swirl()), state.range(1), state.range(2));
}
BENCHMARK(StreamlinesOnTheSphere)
    ->ArgsProduct({{20, 72}, {kEnds, kPoints}, {4, 6, 8}})
    ->ArgNames({"n", "points", "digits"})
    ->Unit(benchmark::kMillisecond);

/// On the gas engine, 26,298 faces, each edge cut in range(0): what users bring has faces of all shapes.
void StreamlinesOnTheGasEngine(benchmark::State& state) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) return state.SkipWithError(test::withoutDataSet("gasEngineV.t").c_str());
  const auto cut = test::subdivided(*data, static_cast<Index>(state.range(0)));
  follow(state, test::fieldOn(cut), state.range(1), state.range(2));
}
BENCHMARK(StreamlinesOnTheGasEngine)
    ->ArgsProduct({{1, 2}, {kEnds, kPoints}, {5, 6, 7}})
    ->ArgNames({"cut", "points", "digits"})
    ->Unit(benchmark::kMillisecond);

/// Storms on a sphere with 20 n^2 faces and 100 lambda samples, both phases of a period of 48 frames.
struct FlowingStorms {
  std::shared_ptr<const FlatFaces> faces;
  std::shared_ptr<const ParameterizedField> field;
  std::vector<double> frames, lambdas;
  AdvectionOptions options{.speed = 0.3};

  explicit FlowingStorms(Index n) {
    const auto charts = test::makeCharts(test::dividedIcosahedron(n));
    faces = std::make_shared<FlatFaces>(charts);
    auto samples = std::make_shared<ParameterizedField>(ParameterizedField{charts, {}, {}});
    std::vector<Complex> values;
    for (int j = 0; j < 100; ++j) {
      const VectorField sample = sampled(charts, analytic::swirl(0.03 * j));
      samples->lambdas.push_back(j / 99.0);
      values.insert(values.end(), sample.values.begin(), sample.values.end());
    }
    samples->values = values;
    field = samples;
    for (int f = 0; f <= 250; ++f) {
      frames.push_back(f);
      lambdas.push_back(0.5 - 0.5 * std::cos(std::numbers::pi * f / 250.0));
    }
  }
  AdvectedCoordinates coordinates() const {
    return {faces, field, frames, lambdas, options, stagger(faces->mesh(), {}, options.deadZone)};
  }
  UnsteadyField flow() const {
    LambdaTrack track{frames, lambdas};
    for (double& t : track.times) t /= options.framesPerSecond;
    return {*faces, *field, track, options.speed};
  }
};

constexpr double kFrame = 120.0;

/// Processor time of the integrator that follows one path at a time, over that of arrivals, for both phases of some
/// vertices that lie near each other.
double timesFaster(const FlowingStorms& storms, const AdvectedCoordinates& coordinates) {
  const auto order = mortonOrder(coordinates.mesh());
  const double period = storms.options.period / storms.options.framesPerSecond;
  std::vector<PathlineSeed> seeds;
  for (std::size_t i = 0; i < std::min(order.size(), std::size_t{8000}); ++i) {
    const double c = kFrame / storms.options.period + coordinates.offsets()[order[i]];
    double ages[2] = {c - std::floor(c), c + 0.5 - std::floor(c + 0.5)};
    std::sort(ages, ages + 2);
    const SurfacePoint p = vertexPoint(coordinates.mesh(), order[i]);
    for (const double age : ages) seeds.push_back({p, kFrame / storms.options.framesPerSecond, age * period});
  }
  const UnsteadyField flow = storms.flow();
  const TraceOptions options{.direction = Direction::Backward, .tolerance = storms.options.tolerance};
  const double alone = processorTime(3, [&] { benchmark::DoNotOptimize(tracePathlineEnds(flow, seeds, options)); });
  return alone / processorTime(3, [&] { benchmark::DoNotOptimize(traceArrivals(flow, seeds, options)); });
}

/// One frame of advected coordinates with every core. The errors are those of the carried coordinates, in mean edge
/// lengths.
void AdvectedFrame(benchmark::State& state) {
  const FlowingStorms storms(static_cast<Index>(state.range(0)));
  const AdvectedCoordinates coordinates = storms.coordinates();
  for (auto _ : state) benchmark::DoNotOptimize(coordinates.frame(kFrame));
  const CarriedError error = coordinates.error(kFrame);
  state.counters["faces"] = coordinates.mesh().faceCount();
  state.counters["mean error"] = error.mean;
  state.counters["largest error"] = error.largest;
  state.counters["mean error between vertices"] = error.meanBetween;
  state.counters["times faster than one path at a time"] = timesFaster(storms, coordinates);
}
BENCHMARK(AdvectedFrame)
    ->Arg(32)
    ->Arg(71)
    ->Arg(158)
    ->ArgName("n")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

/// How the time of a frame grows with faces; and where the speed is that of the 20k faces in edges a second.
void AdvectedFrameGrowth(benchmark::State& state) {
  Growth ofSpeed, ofEdges;
  for (auto _ : state) {
    double edge = 0.0;
    for (const Index n : {32, 71, 158}) {
      FlowingStorms storms(n);
      const double faces = storms.faces->mesh().faceCount();
      const AdvectedCoordinates coordinates = storms.coordinates();
      ofSpeed.add(faces, processorTime(2, [&] { benchmark::DoNotOptimize(coordinates.frame(kFrame)); }));
      if (edge == 0.0) edge = storms.faces->mesh().meanEdgeLength();
      storms.options.speed *= storms.faces->mesh().meanEdgeLength() / edge;
      const AdvectedCoordinates slower = storms.coordinates();
      ofEdges.add(faces, processorTime(2, [&] { benchmark::DoNotOptimize(slower.frame(kFrame)); }));
    }
  }
  ofSpeed.report(state, "exponent, same speed");
  ofEdges.report(state, "exponent, same edges per frame");
}
BENCHMARK(AdvectedFrameGrowth)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Stream functions of 100 samples: one factorization, 100 solves.
void StreamFunctions(benchmark::State& state) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(static_cast<Index>(state.range(0))));
  ParameterizedField field{charts, {}, {}};
  std::vector<Complex> values;
  const VectorField sample = sampled(charts, analytic::swirl());
  for (int j = 0; j < 100; ++j) {
    field.lambdas.push_back(j / 99.0);
    values.insert(values.end(), sample.values.begin(), sample.values.end());
  }
  field.values = values;
  for (auto _ : state) benchmark::DoNotOptimize(streamFunctions(field, StreamFunctionSolver(field.charts)));
}
BENCHMARK(StreamFunctions)->Arg(45)->ArgName("n")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace stormfield
