// The results of fixed computations as one hash each, a line per part of the core. Builds by other compilers, without
// AVX2 or with sanitizers must print the same lines: results are the same bits, not nearly the same (`make test`
// compares them). Only + - * / and square roots are the same everywhere by their standard; sines and the like come from
// the C library, so that the promise is for one machine's library.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "design/design_solve.h"
#include "fixtures.h"
#include "maps/tau_map.h"
#include "maps/transit_map.h"
#include "morse/morse_analysis.h"
#include "solver/storm_constraints.h"
#include "streamlines/evenly_spaced.h"
#include "texture/stream_function.h"
#include "topology/topology.h"
#include "tracing/streamline.h"
#include "tracking/tracking.h"

namespace stormfield::test {
namespace {

/// FNV-1a of the bits.
class Hash {
 public:
  void add(std::uint64_t bits) {
    for (int i = 0; i < 8; ++i) value_ = (value_ ^ ((bits >> (8 * i)) & 0xff)) * 0x100000001b3u;
  }
  template <typename T>
  requires std::is_integral_v<T> || std::is_enum_v<T>
  void add(T number) { add(static_cast<std::uint64_t>(number)); }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(Complex number) { add(number.real()), add(number.imag()); }
  void add(const Vec3& vector) { addAll(std::span(vector.data(), 3)); }
  void add(const SurfacePoint& point) { add(point.face), add(Vec3(point.barycentric)); }
  template <typename Range>
  void addAll(const Range& values) {
    add(std::size(values));
    for (const auto& value : values) add(value);
  }
  void print(std::string_view name) const {
    std::printf("%-22.*s %016llx\n", static_cast<int>(name.size()), name.data(),
                static_cast<unsigned long long>(value_));
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

ParameterizedField solve(const std::shared_ptr<const VertexCharts>& charts) {
  constexpr Index kSamples = 12;
  Progress progress;
  const SpaceTimeSolver solver(charts, {.samples = kSamples});
  const ParameterizedField field = solver.solve(storms::storms(*charts, {.samples = kSamples}), progress).field;
  Hash hash;
  hash.addAll(field.values);
  hash.print("space-time solve");
  return field;
}

void solveDesign(const std::shared_ptr<const VertexCharts>& charts) {
  const Vec3 west = Vec3(-1.0, 0.2, 0.3), east = Vec3(1.0, -0.1, 0.2), south = Vec3(0.1, 0.2, -1.0);
  std::vector<DesignElement> elements(3);
  elements[0].name = "storm", elements[0].kind = SingularKind::SpiralInCcw, elements[0].points = {west, south};
  elements[1].name = "saddle", elements[1].kind = SingularKind::Saddle, elements[1].points = {east};
  elements[2].name = "stream", elements[2].type = ElementType::Streamline, elements[2].points = {east, south};
  for (DesignElement& element : elements) element.radius = 0.3;
  elements[1].hard = true;
  Progress progress;
  DesignSolver solver(charts, {.samples = 8, .evenSpeed = 0.5});
  Hash hash;
  hash.addAll(solver.solve(elements, progress).field.values);
  hash.print("design");
}

void trace(const FlatFaces& faces, const VectorField& field) {
  std::vector<SurfacePoint> seeds;
  for (Index f = 0; f < field.mesh().faceCount(); f += 7) seeds.push_back({f, {0.2, 0.3, 0.5}});
  const Traces lines = traceStreamlines(faces, field, seeds, {.maxLength = 3.0});
  Hash hash;
  hash.addAll(lines.points), hash.addAll(lines.times);
  hash.print("streamlines");
}

void placeLines(const FlatFaces& faces, const VectorField& field) {
  const EvenStreamlines lines = placeStreamlines(faces, field, {.distance = 0.1});
  Hash hash;
  hash.addAll(lines.offsets), hash.addAll(lines.points);
  hash.print("evenly spaced lines");
}

void findEntities(const FlatFaces& faces, const VectorField& field) {
  const Topology topology = findTopology(faces, field);
  Hash hash;
  for (const FixedPoint& p : topology.fixedPoints) hash.add(p.point), hash.add(p.kind), hash.addAll(p.eigenvalues);
  for (const PeriodicOrbit& orbit : topology.periodicOrbits) hash.add(orbit.period), hash.addAll(orbit.points);
  for (const Separatrix& s : topology.separatrices) hash.addAll(s.points), hash.add(s.end.kind), hash.add(s.end.index);
  for (const EntityLink& link : topology.links) hash.add(link.source.index), hash.add(link.target.index);
  hash.print("topology");
}

void addMap(Hash& hash, const CombinatorialMap& map) {
  hash.addAll(map.graph.offsets), hash.addAll(map.graph.targets);
}

void mapTau(const FlatFaces& faces, const VectorField& field) {
  Hash hash;
  for (const TauUnit unit : {TauUnit::Time, TauUnit::Length}) {
    addMap(hash, tauMap(faces, field, unit == TauUnit::Time ? 0.5 : 0.3, {.unit = unit}));
  }
  hash.print("tau maps");
}

void findMorseSets(const VectorField& field, const std::shared_ptr<const FlatFaces>& faces, MorseMethod method,
                   bool refine, std::string_view name) {
  Progress progress;
  const MorseAnalysis analysis = analyzeMorse(faces, field, {.method = method, .refine = refine}, progress);
  Hash hash;
  hash.addAll(analysis.decomposition.faces.setOf());
  for (const MorseSet& set : analysis.decomposition.sets) {
    hash.add(set.kind), hash.add(set.poincare), hash.add(set.persistence);
  }
  for (const auto& [from, to] : analysis.decomposition.graph.edges) hash.add(from), hash.add(to);
  addMap(hash, analysis.model->map());
  hash.print(name);
}

void track(const ParameterizedField& field) {
  Progress progress;
  const Tracking tracking = trackFixedPoints(field, {}, progress);
  Hash hash;
  for (const TrackedPath& path : tracking.paths) {
    hash.add(path.strength), hash.add(path.rotation);
    for (const PathSample& sample : path.samples)
      hash.add(sample.lambda), hash.add(sample.point), hash.add(sample.kind);
  }
  for (const Bifurcation& b : tracking.bifurcations) hash.add(b.lambda), hash.add(b.point), hash.add(b.kind);
  hash.print("tracking");
}

void findStreamFunction(const VectorField& field) {
  Hash hash;
  hash.addAll(StreamFunctionSolver(field.charts).solve(field.values.data()));
  hash.print("stream function");
}

void printAll() {
  const auto charts = makeCharts(bumpySphere(3));
  const ParameterizedField solved = solve(charts);
  solveDesign(charts);
  track(solved);
  const VectorField field = randomField(charts, 5);
  const auto faces = std::make_shared<const FlatFaces>(charts);
  trace(*faces, field);
  placeLines(*faces, at(solved, 0.3));
  findEntities(*faces, field);
  mapTau(*faces, at(solved, 0.7));
  findMorseSets(field, faces, MorseMethod::Geometry, false, "Morse sets");
  findMorseSets(field, faces, MorseMethod::Geometry, true, "Morse sets, halved");
  const auto coarse = makeCharts(bumpySphere(2));
  findMorseSets(randomField(coarse, 5), std::make_shared<const FlatFaces>(coarse), MorseMethod::Tau, true,
                "Morse sets, longer tau");
  findStreamFunction(at(solved, 0.2));
}

}  // namespace
}  // namespace stormfield::test

int main() {
  stormfield::test::printAll();
}
