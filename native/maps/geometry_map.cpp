#include "maps/geometry_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "field/poincare_index.h"

namespace stormfield {
namespace {

/// Fraction of a vector below which its component across an edge is 0: some 50 units of double precision, of which a
/// rotation loses a few.
constexpr double kRoundOff = 1e-14;

/// The vector in the frame whose x axis is the edge: its imaginary part points across, to the left.
Complex inEdgeFrame(Complex vector, double edgeAngle) {
  const Complex rotated = vector * std::polar(1.0, -edgeAngle);
  return std::abs(rotated.imag()) <= kRoundOff * std::abs(rotated) ? Complex(rotated.real(), 0.0) : rotated;
}

EdgeDirections directionsAcross(const VectorField& field, Index h) {
  const EndVectors ends = endVectors(field, h);
  if (holdsFixedPointOnEdge(ends)) return {true, true};
  const auto [tail, head] = ends;
  return {tail.imag() > 0.0 || head.imag() > 0.0, tail.imag() < 0.0 || head.imag() < 0.0};
}

bool hasZeroCorner(const VectorField& field, Index f) {
  for (int k = 0; k < 3; ++k) {
    if (field.values[field.mesh().vertex(f, k)] == 0.0) return true;
  }
  return false;
}

/// A face leads to itself, to its three neighbours or outside: ascending, each once.
struct TargetRow {
  std::array<Index, 4> targets{};
  int count = 0;

  const Index* begin() const { return targets.data(); }
  const Index* end() const { return targets.data() + count; }
  void add(Index target) {
    int at = count;
    while (at > 0 && targets[at - 1] > target) --at;
    if (at > 0 && targets[at - 1] == target) return;
    std::copy_backward(targets.begin() + at, targets.begin() + count, targets.begin() + count + 1);
    targets[at] = target;
    ++count;
  }
};

TargetRow rowOf(const TriangleMesh& mesh, const std::vector<EdgeDirections>& directions, Index f,
                bool holdsFixedPoint) {
  TargetRow row;
  if (holdsFixedPoint) row.add(f);
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    const EdgeDirections& across = directions[mesh.edge(h)];
    const bool leaves = mesh.edgeHalfedge(mesh.edge(h)) == h ? across.outwards : across.inwards;
    const Index twin = mesh.twin(h);
    if (leaves) row.add(twin == kNone ? mesh.faceCount() : TriangleMesh::face(twin));
  }
  return row;
}

}  // namespace

EndVectors endVectors(const VectorField& field, Index h) {
  const VertexCharts& charts = *field.charts;
  return {inEdgeFrame(field.values[charts.mesh().tail(h)], charts.tailAngle(h)),
          inEdgeFrame(field.values[charts.mesh().head(h)], charts.headAngle(h))};
}

bool holdsFixedPointOnEdge(const EndVectors& ends) {
  const auto [tail, head] = ends;
  const bool opposed = tail.imag() == 0.0 && head.imag() == 0.0 && tail.real() * head.real() < 0.0;
  return tail == 0.0 || head == 0.0 || opposed;
}

std::vector<EdgeDirections> edgeDirections(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  std::vector<EdgeDirections> result(mesh.edgeCount());
  tbb::parallel_for(Index{0}, mesh.edgeCount(),
                    [&](Index e) { result[e] = directionsAcross(field, mesh.edgeHalfedge(e)); });
  return result;
}

CombinatorialMap geometryMap(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  const std::vector<EdgeDirections> directions = edgeDirections(field);
  const std::vector<int> indices = poincareIndices(field);
  std::vector<TargetRow> rows(mesh.faceCount());
  tbb::parallel_for(Index{0}, mesh.faceCount(),
                    [&](Index f) { rows[f] = rowOf(mesh, directions, f, indices[f] != 0 || hasZeroCorner(field, f)); });
  return mapFromRows(rows);
}

}  // namespace stormfield
