// Cost of the core on a torus: construction, charts, queries, evaluation, fixed points.
#include <benchmark/benchmark.h>

#include "field/interpolation.h"
#include "fixtures.h"
#include "mesh/closest_point.h"
#include "topology/fixed_points.h"

namespace stormfield::test {
namespace {

/// A torus of about this many vertices.
Surface torusOf(std::int64_t vertices) {
  const int across = static_cast<int>(std::sqrt(static_cast<double>(vertices) / 2.0));
  return torus(2 * across, across);
}

void buildMesh(benchmark::State& state) {
  const Surface s = torusOf(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(makeMesh(s));
  state.SetItemsProcessed(state.iterations() * s.points.rows());
}
BENCHMARK(buildMesh)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond)->UseRealTime();

void buildCharts(benchmark::State& state) {
  const auto mesh = makeMesh(torusOf(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(VertexCharts(mesh));
  state.SetItemsProcessed(state.iterations() * mesh->vertexCount());
}
BENCHMARK(buildCharts)->Arg(100'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond)->UseRealTime();

void closestPoints(benchmark::State& state) {
  const ClosestPointQuery query(makeMesh(torusOf(state.range(0))));
  Random random(1);
  Points points(10'000, 3);
  for (int i = 0; i < 10'000; ++i) points.row(i) = 1.5 * random.vector();
  for (auto _ : state) benchmark::DoNotOptimize(query.closest(points));
  state.SetItemsProcessed(state.iterations() * points.rows());
}
BENCHMARK(closestPoints)->Arg(50'000)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Evaluations at many points of one face: the inner loop of the tracers. Argument: 1 on a curved surface, 0 on a
/// plane.
void evaluateInFace(benchmark::State& state) {
  const VectorField field = randomField(makeCharts(state.range(0) ? torusOf(5'000) : grid(50)), 1);
  const FaceInterpolant local = faceInterpolant(field, 1234);
  Random random(1);
  std::vector<Complex> points(1024);
  for (Complex& p : points) p = local.point(random.barycentric());
  for (auto _ : state) {
    for (const Complex p : points) benchmark::DoNotOptimize(local.evaluate(p));
  }
  state.SetItemsProcessed(state.iterations() * 1024);
}
BENCHMARK(evaluateInFace)->Arg(0)->Arg(1);

/// A random field: one fixed point in about four faces. A smooth one: a handful.
void fixedPointsOfNoise(benchmark::State& state) {
  const VectorField field = randomField(makeCharts(torusOf(state.range(0))), 1);
  for (auto _ : state) benchmark::DoNotOptimize(findFixedPoints(field));
}
BENCHMARK(fixedPointsOfNoise)->Arg(50'000)->Unit(benchmark::kMillisecond)->UseRealTime();

void fixedPointsOfSmoothField(benchmark::State& state) {
  const auto charts = makeCharts(torusOf(state.range(0)));
  const VectorField field = fromSpace(charts, Vec3(1, 2, 3).transpose().replicate(charts->mesh().vertexCount(), 1));
  for (auto _ : state) benchmark::DoNotOptimize(findFixedPoints(field));
}
BENCHMARK(fixedPointsOfSmoothField)->Arg(50'000)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace stormfield::test
