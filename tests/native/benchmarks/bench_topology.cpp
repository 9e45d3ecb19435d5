// The whole entity connection graph, by phase. On the gas engine (where its data set is at hand) the thesis took 31.58
// s for 105,192 faces (table 3.1); equation 3.1 with ten orbits; a million faces of smooth field.
#include <benchmark/benchmark.h>

#include "../data_sets.h"
#include "../topology/flows.h"

namespace stormfield::test {
namespace {

void measure(benchmark::State& state, const VectorField& field) {
  const FlatFaces faces(field.charts);
  std::map<std::string, double> seconds;
  Topology topology;
  for (auto _ : state) {
    topology = findTopology(faces, field);
    for (const auto& [phase, time] : topology.seconds) seconds[phase] += time;
  }
  for (const auto& [phase, time] : seconds) state.counters[phase] = time / static_cast<double>(state.iterations());
  state.counters["faces"] = field.mesh().faceCount();
  state.counters["points"] = static_cast<double>(topology.fixedPoints.size());
  state.counters["orbits"] = static_cast<double>(topology.periodicOrbits.size());
  state.counters["edges"] = static_cast<double>(topology.links.size());
}

/// range(0): 1 for the data as it is, 4 for each face cut in four.
void GasEngine(benchmark::State& state) {
  auto data = dataSet("gasEngineV.t");
  if (!data) {
    state.SkipWithError(withoutDataSet("gasEngineV.t").c_str());
    return;
  }
  if (state.range(0) == 4) data = subdivided(*data);
  measure(state, fieldOn(*data));
  constexpr double kThesis = 31.58;
  if (state.range(0) == 4) {
    state.counters["thesis/ours"] = benchmark::Counter(kThesis, benchmark::Counter::kIsIterationInvariantRate);
  }
}
BENCHMARK(GasEngine)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void TenOrbits(benchmark::State& state) {
  measure(state, sampledOn(scaled(grid(static_cast<int>(state.range(0))), 10.999 * kPi), equation31));
}
BENCHMARK(TenOrbits)->Arg(440)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

void SmoothField(benchmark::State& state) {
  measure(state, smoothField(icosphere(static_cast<int>(state.range(0))), 1));
}
BENCHMARK(SmoothField)->Arg(6)->Arg(8)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

}  // namespace
}  // namespace stormfield::test
