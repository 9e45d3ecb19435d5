// The space-time solver in passes: its time over that of one plain float32 stencil sweep, measured in the same run,
// beside plain conjugate gradients (and, as the solver takes AVX2 where there is, in sweeps that do too); what its
// stopping rule leaves, as relative residual and as difference to the exact field; its peak memory in unknown vectors;
// its growth in vertices and samples.
#include <benchmark/benchmark.h>

#include <chrono>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "../solver/storm_constraints.h"
#include "design/even_speed.h"
#include "fixtures.h"
#include "plain_solver.h"

namespace stormfield {
namespace {

/// Wall time, and processor time of all threads: their ratio shows how much other work the machine has.
struct Time {
  double wall = std::numeric_limits<double>::infinity();
  double processor = std::numeric_limits<double>::infinity();
};

/// Takes the shortest of this run and those before.
template <typename Run>
void time(Time& best, const Run& run) {
  const auto wall = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  run();
  best.processor = std::min(best.processor, static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
  best.wall = std::min(best.wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count());
}

/// A line of /proc/self/status in bytes, 0 where there is none.
double processBytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(name + ":", 0) == 0) return 1024.0 * std::stod(line.substr(name.size() + 1));
  }
  return 0.0;
}

/// Bytes that are held, without what the allocator keeps.
double heldBytes() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  return processBytes("VmRSS");
}

/// Bytes that run needs at its peak beyond what is there before.
template <typename Run>
double peakBytes(const Run& run) {
  const double before = heldBytes();
  std::ofstream("/proc/self/clear_refs") << 5;
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

/// Of a field to the exact one, relative, in the mean square over surface and lambda.
double difference(const ParameterizedField& field, const ParameterizedField& exact) {
  const TriangleMesh& mesh = field.charts->mesh();
  double square = 0.0, whole = 0.0;
  for (Index j = 0; j < field.sampleCount(); ++j) {
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      square += mesh.vertexArea(v) * std::norm(field.sample(j)[v] - exact.sample(j)[v]);
      whole += mesh.vertexArea(v) * std::norm(exact.sample(j)[v]);
    }
  }
  return std::sqrt(square / whole);
}

/// Two storms on a sphere, about range(0) vertices x range(1) samples; then one of them moves by a tenth of its radius.
void SolveStorms(benchmark::State& state) {
  const Index n = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(state.range(0)) / 10.0)));
  const auto charts = test::makeCharts(test::dividedIcosahedron(n));
  SpaceTimeOptions options;
  options.samples = static_cast<Index>(state.range(1));
  const ConstraintSet before = storms::storms(*charts, stormOptions(options.samples));
  const ConstraintSet after = storms::storms(*charts, stormOptions(options.samples, 0.053));
  const SpaceTimeSolver solver(charts, options);
  const plain::PlainSolver plainSolver(*charts, options, before);
  std::vector<plain::Single> x(plainSolver.size(), 1.0f), y(plainSolver.size());
  Progress progress;
  Time sweep, wideSweep, cold, warm, setup, plain;
  SpaceTimeState kept;
  SpaceTimeResult first, second;
  // Taken in turns, so that other load on the machine meets all of them.
  for (auto _ : state) {
    for (int k = 0; k < 3; ++k) time(sweep, [&] { plainSolver.sweep(x, y); });
    for (int k = 0; k < 3; ++k) time(wideSweep, [&] { plainSolver.wideSweep(x, y); });
    time(cold, [&] { first = solver.solve(before, progress); });
    solver.solve(before, progress, kept);
    time(warm, [&] { second = solver.solve(after, progress, kept); });
    time(setup, [&] { SpaceTimeSolver(charts, options); });
  }
  int plainIterations = 0;
  time(plain, [&] { plainIterations = plainSolver.solve(options.tolerance); });
  SpaceTimeOptions fine = options;
  fine.tolerance = 1e-9;
  const SpaceTimeSolver exact(charts, fine);
  state.counters["cold L2 difference"] = difference(first.field, exact.solve(before, progress).field);
  state.counters["warm L2 difference"] = difference(second.field, exact.solve(after, progress).field);
  state.counters["cold L2 difference, estimated"] = first.error;
  state.counters["warm L2 difference, estimated"] = second.error;
  first.field = {};
  const double unknownVector = static_cast<double>(plainSolver.size()) * sizeof(plain::Single);
  kept = {};
  second.field = {};
  // The second solve holds what the first one left.
  SpaceTimeState own;
  const double base = heldBytes();
  const double coldPeak = peakBytes([&] { solver.solve(before, progress, own); });
  const double held = heldBytes() - base;
  const double peak = std::max(coldPeak, held + peakBytes([&] { solver.solve(after, progress, own); }));
  state.counters["kept (vectors)"] = held / unknownVector;
  state.counters["memory (vectors)"] = peak / unknownVector;
  state.counters["cold passes of AVX2 sweeps, processor"] = cold.processor / wideSweep.processor;
  state.counters["warm passes of AVX2 sweeps, processor"] = warm.processor / wideSweep.processor;
  state.counters["sweep ms"] = 1e3 * sweep.wall;
  state.counters["cold ms"] = 1e3 * cold.wall;
  state.counters["warm ms"] = 1e3 * warm.wall;
  state.counters["cold steps"] = first.iterations;
  state.counters["warm steps"] = second.iterations;
  state.counters["plain CG steps"] = plainIterations;
  state.counters["cold residual"] = first.residual;
  state.counters["warm residual"] = second.residual;
  auto passes = [&](const char* name, const Time& t) {
    state.counters[std::string(name) + " passes"] = t.wall / sweep.wall;
    state.counters[std::string(name) + " passes, processor"] = t.processor / sweep.processor;
  };
  passes("cold", cold);
  passes("warm", warm);
  passes("hierarchy", setup);
  passes("plain CG", plain);
}
BENCHMARK(SolveStorms)->Args({20000, 100})->Unit(benchmark::kMillisecond)->Iterations(20);

/// Exponents of the processor time of hierarchy and solve from 20k vertices x 20 samples to 1M x 20, and from 20k x 25
/// to 20k x 400.
void SolveGrowth(benchmark::State& state) {
  struct Run {
    double unknowns;
    Time best;
  };
  auto measure = [](Index n, Index samples, int repeats) -> Run {
    const auto charts = test::makeCharts(test::dividedIcosahedron(n));
    SpaceTimeOptions options;
    options.samples = samples;
    const ConstraintSet constraints = storms::storms(*charts, stormOptions(samples));
    Progress progress;
    Time best;
    for (int k = 0; k < repeats; ++k) {
      time(best, [&] { SpaceTimeSolver(charts, options).solve(constraints, progress); });
    }
    return {static_cast<double>(charts->mesh().vertexCount()) * samples, best};
  };
  auto exponent = [](const Run& a, const Run& b) {
    return std::log(b.best.processor / a.best.processor) / std::log(b.unknowns / a.unknowns);
  };
  for (auto _ : state) {
    const Run small = measure(45, 20, 3), middle = measure(141, 20, 2), large = measure(316, 20, 2);
    state.counters["20k to 200k vertices"] = exponent(small, middle);
    state.counters["200k to 1M vertices"] = exponent(middle, large);
    state.counters["1M x 20 s"] = large.best.wall;
    state.counters["25 to 400 samples"] = exponent(measure(45, 25, 3), measure(45, 400, 1));
  }
}
BENCHMARK(SolveGrowth)->Unit(benchmark::kSecond)->Iterations(1);

/// Even speed on the result of a solve.
void EvenSpeed(benchmark::State& state) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(45));
  Progress progress;
  const ParameterizedField field =
      SpaceTimeSolver(charts).solve(storms::storms(*charts, stormOptions(100)), progress).field;
  for (auto _ : state) benchmark::DoNotOptimize(evenSpeed(field, 1.0, 0.1));
}
BENCHMARK(EvenSpeed)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stormfield
