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

/// Chart angles; a zero vector counts as lying along the x axis.
std::vector<double> chartAngles(const TriangleMesh& mesh, const Complex* values) {
  std::vector<double> angles(mesh.vertexCount());
  tbb::parallel_for(Index{0}, mesh.vertexCount(), [&](Index v) {
    // Adding zero makes 0 of -0, so that every zero vector has the same angle.
    angles[v] = std::atan2(values[v].imag() + 0.0, values[v].real() + 0.0);
  });
  return angles;
}

}  // namespace

std::vector<double> edgeRotations(const VertexCharts& charts, const Complex* values) {
  const TriangleMesh& mesh = charts.mesh();
  const std::vector<double> angles = chartAngles(mesh, values);
  std::vector<double> rotations(mesh.edgeCount());
  tbb::parallel_for(Index{0}, mesh.edgeCount(), [&](Index e) {
    const Index h = mesh.edgeHalfedge(e);
    rotations[e] = wrapped(angles[mesh.head(h)] - charts.headAngle(h) - (angles[mesh.tail(h)] - charts.tailAngle(h)));
  });
  return rotations;
}

std::vector<int> poincareIndices(const VertexCharts& charts, const Complex* values) {
  const TriangleMesh& mesh = charts.mesh();
  const std::vector<double> rotations = edgeRotations(charts, values);
  std::vector<int> indices(mesh.faceCount());
  tbb::parallel_for(Index{0}, mesh.faceCount(), [&](Index f) {
    double angle = 0.0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index e = mesh.edge(h);
      angle += mesh.edgeHalfedge(e) == h ? rotations[e] : -rotations[e];
      angle -= (1.0 - charts.scale(mesh.tail(h))) * mesh.cornerAngle(h);
    }
    indices[f] = static_cast<int>(std::lround(angle / (2.0 * kPi)));
  });
  return indices;
}

std::vector<int> poincareIndices(const VectorField& field) {
  return poincareIndices(*field.charts, field.values.data());
}

}  // namespace stormfield
