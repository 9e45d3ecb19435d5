#include "solver/connection_laplacian.h"

#include <algorithm>
#include <cmath>

#include "mesh/morton_order.h"

namespace stormfield {
namespace {

/// Weights of slivers are cut here: larger ones would make the others round-off.
constexpr double kMaxWeight = 1e4;
/// Weights of right angles that rounding makes a little positive.
constexpr double kMinWeight = 1e-12;

double oppositeCotangent(const TriangleMesh& mesh, Index h) {
  return 1.0 / std::tan(mesh.cornerAngle(TriangleMesh::prev(h)));
}

std::vector<double> edgeWeights(const TriangleMesh& mesh) {
  std::vector<double> weights(mesh.edgeCount());
  for (Index e = 0; e < mesh.edgeCount(); ++e) weights[e] = edgeWeight(mesh, e);
  return weights;
}

}  // namespace

double edgeWeight(const TriangleMesh& mesh, Index e) {
  const Index h = mesh.edgeHalfedge(e);
  double w = oppositeCotangent(mesh, h);
  if (mesh.twin(h) != kNone) w += oppositeCotangent(mesh, mesh.twin(h));
  w *= 0.5;
  return w < kMinWeight ? 0.0 : std::min(w, kMaxWeight);
}

ConnectionLaplacian connectionLaplacian(const VertexCharts& charts) {
  const TriangleMesh& mesh = charts.mesh();
  const std::vector<double> weights = edgeWeights(mesh);
  ConnectionLaplacian result;
  result.vertex = mortonOrder(mesh);
  std::vector<Index> rowOf(mesh.vertexCount(), kNone);
  for (std::size_t i = 0; i < result.vertex.size(); ++i) rowOf[result.vertex[i]] = static_cast<Index>(i);

  SurfaceMatrix& matrix = result.matrix;
  matrix.start.reserve(result.vertex.size() + 1);
  matrix.column.reserve(2 * mesh.edgeCount());
  matrix.value.reserve(2 * mesh.edgeCount());
  matrix.diagonal.reserve(result.vertex.size());
  matrix.mass.reserve(result.vertex.size());
  std::vector<std::pair<Index, Complex>> row;
  for (const Index v : result.vertex) {
    row.clear();
    double diagonal = 0.0;
    auto couple = [&](Index neighbour, Index edge, Complex carry) {
      if (weights[edge] == 0.0) return;
      row.emplace_back(rowOf[neighbour], -weights[edge] * carry);
      diagonal += weights[edge];
    };
    for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
      couple(mesh.head(h), mesh.edge(h), std::conj(charts.transport(h)));
      // The last edge of a boundary fan has no outgoing halfedge of its own.
      const Index incoming = TriangleMesh::prev(h);
      if (mesh.twin(incoming) == kNone) couple(mesh.tail(incoming), mesh.edge(incoming), charts.transport(incoming));
    }
    std::sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [column, value] : row) {
      matrix.column.push_back(column);
      matrix.value.push_back(value);
    }
    matrix.start.push_back(matrix.column.size());
    matrix.diagonal.push_back(diagonal);
    matrix.mass.push_back(mesh.vertexArea(v) / mesh.totalArea());
  }
  return result;
}

}  // namespace stormfield
