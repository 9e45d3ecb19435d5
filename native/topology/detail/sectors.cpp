#include "topology/detail/sectors.h"

#include <numbers>

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;
/// Nearer than this (barycentric) to an edge or a vertex is on it.
constexpr double kOnBorder = 1e-6;

/// Position of a halfedge's tail in the flat frame of its face.
Complex tailInFace(const TriangleMesh& mesh, Index h) {
  const Index f = TriangleMesh::face(h), h0 = 3 * f;
  if (h == h0) return Complex(0.0);
  if (h == h0 + 1) return Complex(mesh.edgeLength(mesh.edge(h0)));
  return std::polar(mesh.edgeLength(mesh.edge(h0 + 2)), mesh.cornerAngle(h0));
}

}  // namespace

std::vector<Sector> sectorsAround(const VertexCharts& charts, const SurfacePoint& p) {
  const TriangleMesh& mesh = charts.mesh();
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] < 1.0 - kOnBorder) continue;
    std::vector<Sector> fan;
    for (Index h = mesh.outgoing(mesh.vertex(p.face, k)); h != kNone; h = mesh.nextOutgoing(h)) {
      fan.push_back({TriangleMesh::face(h), tailInFace(mesh, h), charts.faceAngle(h), mesh.cornerAngle(h)});
    }
    return fan;
  }
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] > kOnBorder) continue;
    const Index h = TriangleMesh::halfedge(p.face, (k + 1) % 3), twin = mesh.twin(h);
    const double fraction = p.barycentric[(k + 2) % 3] / (p.barycentric[(k + 1) % 3] + p.barycentric[(k + 2) % 3]);
    const auto half = [&](Index side, double along) {
      const Complex apex = (1.0 - along) * tailInFace(mesh, side) + along * tailInFace(mesh, TriangleMesh::next(side));
      return Sector{TriangleMesh::face(side), apex, charts.faceAngle(side), kPi};
    };
    if (twin == kNone) return {half(h, fraction)};
    return {half(h, fraction), half(twin, 1.0 - fraction)};
  }
  const Index h = 3 * p.face;
  const Complex apex = p.barycentric[1] * tailInFace(mesh, h + 1) + p.barycentric[2] * tailInFace(mesh, h + 2);
  return {{p.face, apex, 0.0, 2.0 * kPi}};
}

bool surroundsPoint(const VertexCharts& charts, const SurfacePoint& p, const std::vector<Sector>& sectors) {
  const TriangleMesh& mesh = charts.mesh();
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] >= 1.0 - kOnBorder) return !mesh.isBoundaryVertex(mesh.vertex(p.face, k));
  }
  return sectors.size() > 1 || sectors.front().opening > 1.5 * kPi;
}

}  // namespace stormfield
