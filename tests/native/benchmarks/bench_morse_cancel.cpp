// What Esc waits for: wall time from a Progress being cancelled to the end of the work, the worst and the mean of 20
// tries at moments spread over it, on the gas engine of the thesis. Skipped without the data.
#include <benchmark/benchmark.h>

#include <chrono>
#include <thread>

#include "data_sets.h"
#include "morse/morse_analysis.h"

namespace stormfield {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

/// From the cancelling, after so many seconds of work, to its end; 0 for work that ends before.
template <typename Work>
double timeToEnd(const Work& work, double after) {
  Progress progress;
  Clock::time_point cancelled;
  std::thread watcher([&] {
    std::this_thread::sleep_for(std::chrono::duration<double>(after));
    cancelled = Clock::now();
    progress.cancel();
  });
  try {
    work(progress);
  } catch (const Cancelled&) {
  }
  const Clock::time_point ended = Clock::now();
  watcher.join();
  return std::max(0.0, seconds(ended - cancelled));
}

void CancelMorse(benchmark::State& state, MorseMethod method, bool refine) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) return state.SkipWithError(test::withoutDataSet("gasEngineV.t").c_str());
  const VectorField field = test::fieldOn(*data);
  const auto faces = std::make_shared<const FlatFaces>(field.charts);
  MorseAnalysisOptions options;
  options.method = method;
  options.refine = refine;
  const auto work = [&](Progress& progress) { analyzeMorse(faces, field, options, progress); };
  constexpr int kTries = 20;
  constexpr double kMaxSeconds = 0.8;
  for (auto _ : state) {
    Progress progress;
    options.maxSeconds = kMaxSeconds;
    const auto began = Clock::now();
    work(progress);
    const double whole = seconds(Clock::now() - began);
    options.maxSeconds = std::numeric_limits<double>::infinity();
    double worst = 0.0, sum = 0.0;
    for (int i = 0; i < kTries; ++i) {
      const double time = timeToEnd(work, whole * (i + 0.5) / kTries);
      worst = std::max(worst, time);
      sum += time;
    }
    state.counters["worst ms"] = 1e3 * worst;
    state.counters["mean ms"] = 1e3 * sum / kTries;
  }
}
BENCHMARK_CAPTURE(CancelMorse, directions, MorseMethod::Geometry, false)->Unit(benchmark::kSecond)->Iterations(1);
BENCHMARK_CAPTURE(CancelMorse, directions_refined, MorseMethod::Geometry, true)
    ->Unit(benchmark::kSecond)
    ->Iterations(1);
BENCHMARK_CAPTURE(CancelMorse, tau_map, MorseMethod::Tau, false)->Unit(benchmark::kSecond)->Iterations(1);
BENCHMARK_CAPTURE(CancelMorse, tau_refined, MorseMethod::Tau, true)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace stormfield
