#include "field/poincare_index.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;

/// To (-pi, pi].
double wrapped(double angle) {
  const double inside = angle - 2.0 * kPi * std::round(angle / (2.0 * kPi));
  return inside <= -kPi ? inside + 2.0 * kPi : inside;
}

/// A zero vector counts as lying along the x axis.
double chartAngle(Complex value) {
  // Adding zero makes 0 of -0, so that every zero vector has the same angle.
  return std::atan2(value.imag() + 0.0, value.real() + 0.0);
}

std::vector<double> chartAngles(const TriangleMesh& mesh, const Complex* values) {
  std::vector<double> angles(mesh.vertexCount());
  tbb::parallel_for(Index{0}, mesh.vertexCount(), [&](Index v) { angles[v] = chartAngle(values[v]); });
  return angles;
}

/// Along an edge's own halfedge, from the chart angles of its tail and head.
double edgeRotation(const VertexCharts& charts, Index halfedge, double tail, double head) {
  return wrapped(head - charts.headAngle(halfedge) - (tail - charts.tailAngle(halfedge)));
}

/// rotationOf(edge) -> double
template <typename Rotation>
int indexOf(const VertexCharts& charts, Index f, Rotation&& rotationOf) {
  const TriangleMesh& mesh = charts.mesh();
  double angle = 0.0;
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    const Index e = mesh.edge(h);
    const double rotation = rotationOf(e);
    angle += mesh.edgeHalfedge(e) == h ? rotation : -rotation;
    angle -= (1.0 - charts.scale(mesh.tail(h))) * mesh.cornerAngle(h);
  }
  return static_cast<int>(std::lround(angle / (2.0 * kPi)));
}

}  // namespace

std::vector<double> edgeRotations(const VertexCharts& charts, const Complex* values) {
  const TriangleMesh& mesh = charts.mesh();
  const std::vector<double> angles = chartAngles(mesh, values);
  std::vector<double> rotations(mesh.edgeCount());
  tbb::parallel_for(Index{0}, mesh.edgeCount(), [&](Index e) {
    const Index h = mesh.edgeHalfedge(e);
    rotations[e] = edgeRotation(charts, h, angles[mesh.tail(h)], angles[mesh.head(h)]);
  });
  return rotations;
}

std::vector<int> poincareIndices(const VertexCharts& charts, const Complex* values) {
  const TriangleMesh& mesh = charts.mesh();
  const std::vector<double> rotations = edgeRotations(charts, values);
  std::vector<int> indices(mesh.faceCount());
  tbb::parallel_for(Index{0}, mesh.faceCount(),
                    [&](Index f) { indices[f] = indexOf(charts, f, [&](Index e) { return rotations[e]; }); });
  return indices;
}

std::vector<int> poincareIndices(const VectorField& field) {
  return poincareIndices(*field.charts, field.values.data());
}

int poincareIndex(const VectorField& field, Index face) {
  const TriangleMesh& mesh = field.mesh();
  return indexOf(*field.charts, face, [&](Index e) {
    const Index h = mesh.edgeHalfedge(e);
    return edgeRotation(*field.charts, h, chartAngle(field.values[mesh.tail(h)]),
                        chartAngle(field.values[mesh.head(h)]));
  });
}

}  // namespace stormfield
