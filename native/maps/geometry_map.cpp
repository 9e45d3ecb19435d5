#include "maps/geometry_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "field/poincare_index.h"

namespace stormfield {
namespace {

constexpr double kRoundOff = 1e-14;

/// The vector with the edge along the x axis: its imaginary part points across, to the left.
Complex seenAlong(Complex vector, double edgeAngle) {
  const Complex turned = vector * std::polar(1.0, -edgeAngle);
  return std::abs(turned.imag()) <= kRoundOff * std::abs(turned) ? Complex(turned.real(), 0.0) : turned;
}

EdgeDirections crossing(const VectorField& field, Index h) {
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
struct Row {
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

Row rowOf(const TriangleMesh& mesh, const std::vector<EdgeDirections>& crossings, Index f, bool restsInside) {
  Row row;
  if (restsInside) row.add(f);
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    const EdgeDirections& crossing = crossings[mesh.edge(h)];
    const bool leaves = mesh.edgeHalfedge(mesh.edge(h)) == h ? crossing.outwards : crossing.inwards;
    const Index twin = mesh.twin(h);
    if (leaves) row.add(twin == kNone ? mesh.faceCount() : TriangleMesh::face(twin));
  }
  return row;
}

}  // namespace

EndVectors endVectors(const VectorField& field, Index h) {
  const VertexCharts& charts = *field.charts;
  return {seenAlong(field.values[charts.mesh().tail(h)], charts.tailAngle(h)),
          seenAlong(field.values[charts.mesh().head(h)], charts.headAngle(h))};
}

bool holdsFixedPointOnEdge(const EndVectors& ends) {
  const auto [tail, head] = ends;
  const bool opposed = tail.imag() == 0.0 && head.imag() == 0.0 && tail.real() * head.real() < 0.0;
  return tail == 0.0 || head == 0.0 || opposed;
}

std::vector<EdgeDirections> edgeDirections(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  std::vector<EdgeDirections> result(mesh.edgeCount());
  tbb::parallel_for(Index{0}, mesh.edgeCount(), [&](Index e) { result[e] = crossing(field, mesh.edgeHalfedge(e)); });
  return result;
}

CombinatorialMap geometryMap(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  const std::vector<EdgeDirections> crossings = edgeDirections(field);
  const std::vector<int> indices = poincareIndices(field);
  std::vector<Row> rows(mesh.faceCount());
  tbb::parallel_for(Index{0}, mesh.faceCount(),
                    [&](Index f) { rows[f] = rowOf(mesh, crossings, f, indices[f] != 0 || hasZeroCorner(field, f)); });
  return mapFromRows(rows);
}

}  // namespace stormfield
