// Evenly spaced streamlines on the gas engine, subdivided to 105,192 faces: seconds, and how even they are. The peer is
// what the same lines cost without any test of distance: the streamlines alone, from their seeds to their ends.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>

#include "data_sets.h"
#include "streamlines/spacing_checks.h"
#include "streamlines/topology_features.h"
#include "tracing/streamline.h"

namespace stormfield {
namespace {

/// Part of the sampled points of lines by their distance to the nearest other line, in tenths of d.
void printHistogram(const TriangleMesh& mesh, const EvenStreamlines& lines, double d) {
  const auto segments = test::segmentsOf(mesh, lines);
  std::array<int, 13> count{};
  int all = 0;
  for (std::size_t i = 0; i + 1 < lines.offsets.size(); ++i) {
    for (std::size_t k = lines.offsets[i]; k < lines.offsets[i + 1]; ++k) {
      // Every 16th of all points, not of each line's: lines begin at saddles, where separatrices meet.
      if (k % 16 != 0) continue;
      ++all;
      const double near = test::distanceToLines(mesh, segments, lines.points[k], 0.0, static_cast<Index>(i));
      ++count[static_cast<std::size_t>(std::clamp(10.0 * near / d, 0.0, 12.0))];
    }
  }
  std::printf("distance of points to the nearest other line, in tenths of d:\n");
  for (std::size_t i = 0; i < count.size(); ++i)
    std::printf("  %2zu%s %5.1f %%\n", i, i == 12 ? "+" : " ", 100.0 * count[i] / all);
}

/// The largest distance to a line of one point in every 32nd face where the field flows.
double sampledGap(const VectorField& field, const EvenStreamlines& lines) {
  const TriangleMesh& mesh = field.mesh();
  const auto segments = test::segmentsOf(mesh, lines);
  double largest = 0.0;
  for (Index f = 0; f < mesh.faceCount(); f += 32) {
    const SurfacePoint p{f, Eigen::Vector3d::Constant(1.0 / 3.0)};
    if (evaluate(field, p).norm() > 0.0) largest = std::max(largest, test::distanceToLines(mesh, segments, p, -0.72));
  }
  return largest;
}

/// Argument: the distance d in thousandths of the object's size.
void EvenlySpacedStreamlines(benchmark::State& state) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) return state.SkipWithError(test::withoutDataSet("gasEngineV.t").c_str());
  const VectorField field = test::fieldOn(test::subdivided(*data));
  const FlatFaces faces(field.charts);
  const double d = 1e-3 * static_cast<double>(state.range(0)) * field.mesh().size();
  const StreamlineFeatures features = featuresOf(findTopology(faces, field));
  EvenStreamlines lines;
  for (auto _ : state) lines = placeStreamlines(faces, field, {.distance = d}, features);
  printHistogram(field.mesh(), lines, d);
  state.counters["lines"] = static_cast<double>(lines.closed.size());
  state.counters["points"] = static_cast<double>(lines.points.size());
  state.counters["gaps"] = static_cast<double>(lines.gaps.size());
  state.counters["largest_distance/d"] = sampledGap(field, lines) / d;
}

void TheSameLinesTraced(benchmark::State& state) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) return state.SkipWithError(test::withoutDataSet("gasEngineV.t").c_str());
  const VectorField field = test::fieldOn(test::subdivided(*data));
  const FlatFaces faces(field.charts);
  const double d = 1e-3 * static_cast<double>(state.range(0)) * field.mesh().size();
  const EvenStreamlines lines = placeStreamlines(faces, field, {.distance = d});
  for (auto _ : state) {
    for (std::size_t i = 0; i + 1 < lines.offsets.size(); ++i) {
      const double length = lines.arc[lines.offsets[i + 1] - 1];
      benchmark::DoNotOptimize(traceStreamline(faces, field, lines.points[lines.offsets[i]], {.maxLength = length}));
    }
  }
}

BENCHMARK(EvenlySpacedStreamlines)->Arg(10)->Arg(20)->Unit(benchmark::kSecond)->MeasureProcessCPUTime()->Iterations(1);
BENCHMARK(TheSameLinesTraced)->Arg(10)->Arg(20)->Unit(benchmark::kSecond)->MeasureProcessCPUTime()->Iterations(1);

}  // namespace
}  // namespace stormfield
