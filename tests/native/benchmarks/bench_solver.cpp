// The space-time solver in passes: its wall time over that of one plain float32 stencil sweep, measured in the same
// run, beside plain conjugate gradients; its peak memory in unknown vectors; its growth in vertices and samples.
#include <benchmark/benchmark.h>

#include <chrono>
#include <fstream>
#include <limits>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "../design/storm_constraints.h"
#include "../tracing/surfaces.h"
#include "design/even_speed.h"
#include "plain_solver.h"

namespace stormfield {
namespace {

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Shortest of several runs.
template <typename Run>
double timed(int repeats, const Run& run) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < repeats; ++k) {
    const double start = seconds();
    run();
    best = std::min(best, seconds() - start);
  }
  return best;
}

/// A line of /proc/self/status in bytes, 0 where there is none.
double processBytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(name + ":", 0) == 0) return 1024.0 * std::stod(line.substr(name.size() + 1));
  }
  return 0.0;
}

/// Bytes that run needs at its peak beyond what is there before.
template <typename Run>
double peakBytes(const Run& run) {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::ofstream("/proc/self/clear_refs") << 5;
  const double before = processBytes("VmRSS");
  run();
  return processBytes("VmHWM") - before;
}

storms::StormOptions stormOptions(Index samples, double shift = 0.0) {
  storms::StormOptions options;
  options.samples = samples;
  options.weight = 1e4 / (options.radius * options.radius);
  options.shift = shift;
  return options;
}

/// Two storms on a sphere, about range(0) vertices x range(1) samples; then one of them moves by a tenth of its radius.
void SolveStorms(benchmark::State& state) {
  const Index n = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(state.range(0)) / 10.0)));
  const auto charts = surfaces::sphere(n);
  SpaceTimeOptions options;
  options.samples = static_cast<Index>(state.range(1));
  const ConstraintSet before = storms::storms(*charts, stormOptions(options.samples));
  const ConstraintSet after = storms::storms(*charts, stormOptions(options.samples, 0.053));
  const SpaceTimeSolver solver(charts, options);
  const plain::PlainSolver plainSolver(*charts, options, before);
  std::vector<plain::Single> x(plainSolver.size(), 1.0f), y(plainSolver.size());
  Progress progress;
  double sweep = std::numeric_limits<double>::infinity();
  double cold = sweep, warm = sweep;
  SpaceTimeResult first, second;
  // Taken in turns, so that other load on the machine meets all three.
  for (auto _ : state) {
    sweep = std::min(sweep, timed(3, [&] { plainSolver.sweep(x, y); }));
    cold = std::min(cold, timed(1, [&] { first = solver.solve(before, progress); }));
    warm = std::min(warm, timed(1, [&] { second = solver.solve(after, progress, &first.field); }));
  }
  const double setup = timed(1, [&] { SpaceTimeSolver(charts, options); });
  int plainIterations = 0;
  const double plainTime = timed(1, [&] { plainIterations = plainSolver.solve(options.tolerance); });
  const double unknownVector = static_cast<double>(plainSolver.size()) * sizeof(plain::Single);
  second = {};
  state.counters["memory (vectors)"] =
      peakBytes([&] { second = solver.solve(after, progress, &first.field); }) / unknownVector;
  state.counters["sweep ms"] = 1e3 * sweep;
  state.counters["cold passes"] = cold / sweep;
  state.counters["cold steps"] = first.iterations;
  state.counters["cold residual"] = first.residual;
  state.counters["warm passes"] = warm / sweep;
  state.counters["warm steps"] = second.iterations;
  state.counters["warm residual"] = second.residual;
  state.counters["hierarchy passes"] = setup / sweep;
  state.counters["plain CG passes"] = plainTime / sweep;
  state.counters["plain CG steps"] = plainIterations;
}
BENCHMARK(SolveStorms)->Args({20000, 100})->Unit(benchmark::kMillisecond)->Iterations(20);

/// Exponents of the time of hierarchy and solve from 20k vertices x 20 samples to 1M x 20, and from 20k x 25 to 20k x
/// 400.
void SolveGrowth(benchmark::State& state) {
  struct Run {
    double unknowns, time;
  };
  auto measure = [](Index n, Index samples, int repeats) -> Run {
    const auto charts = surfaces::sphere(n);
    SpaceTimeOptions options;
    options.samples = samples;
    const ConstraintSet constraints = storms::storms(*charts, stormOptions(samples));
    Progress progress;
    const double time = timed(repeats, [&] { SpaceTimeSolver(charts, options).solve(constraints, progress); });
    return {static_cast<double>(charts->mesh().vertexCount()) * samples, time};
  };
  auto exponent = [](const Run& a, const Run& b) {
    return std::log(b.time / a.time) / std::log(b.unknowns / a.unknowns);
  };
  for (auto _ : state) {
    const Run small = measure(45, 20, 3), middle = measure(141, 20, 2), large = measure(316, 20, 1);
    state.counters["20k to 200k vertices"] = exponent(small, middle);
    state.counters["200k to 1M vertices"] = exponent(middle, large);
    state.counters["1M x 20 s"] = large.time;
    state.counters["25 to 400 samples"] = exponent(measure(45, 25, 3), measure(45, 400, 1));
  }
}
BENCHMARK(SolveGrowth)->Unit(benchmark::kSecond)->Iterations(1);

/// Even speed on the result of a solve.
void EvenSpeed(benchmark::State& state) {
  const auto charts = surfaces::sphere(45);
  Progress progress;
  const ParameterizedField field =
      SpaceTimeSolver(charts).solve(storms::storms(*charts, stormOptions(100)), progress).field;
  for (auto _ : state) benchmark::DoNotOptimize(evenSpeed(field, 1.0, 0.1));
}
BENCHMARK(EvenSpeed)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stormfield
