#include "field/interpolation.h"

namespace stormfield {
namespace {

/// Charts of flat vertices differ from the plane by round-off only; their twist is dropped.
constexpr double kNoTwist = 1e-14;

std::array<Complex, 3> cornerValues(const VectorField& field, Index f) {
  const TriangleMesh& mesh = field.mesh();
  return {field.values[mesh.vertex(f, 0)], field.values[mesh.vertex(f, 1)], field.values[mesh.vertex(f, 2)]};
}

}  // namespace

FaceInterpolant::FaceInterpolant(const VertexCharts& charts, Index f, const std::array<Complex, 3>& vertexValues) {
  const TriangleMesh& mesh = charts.mesh();
  const Index h0 = TriangleMesh::halfedge(f, 0);
  doubleArea = 2.0 * mesh.faceArea(f);
  // Base and height: the corners then enclose exactly the face's area.
  const double base = mesh.edgeLength(mesh.edge(h0));
  const double foot = mesh.edgeLength(mesh.edge(h0 + 2)) * std::cos(mesh.cornerAngle(h0));
  corners = {Complex(0.0), Complex(base), Complex(foot, doubleArea / base)};
  for (int i = 0; i < 3; ++i) {
    const Index h = h0 + i;
    const double half = 0.5 * mesh.cornerAngle(h);
    const double scale = charts.scale(mesh.vertex(f, i));
    twist[i] = std::abs(1.0 - scale) < kNoTwist ? 0.0 : 1.0 - scale;
    bisector[i] = std::polar(1.0, charts.faceAngle(h) + half);
    carried[i] = vertexValues[i] * std::polar(1.0, charts.faceAngle(h) - charts.tailAngle(h) + twist[i] * half);
  }
}

Eigen::Matrix2d FaceInterpolant::jacobian(Complex p) const {
  const Eigen::Vector3d b = barycentric(p);
  Complex dx = 0.0, dy = 0.0;
  for (int i = 0; i < 3; ++i) {
    // The barycentric coordinate grows across the opposite side, towards the corner.
    const Complex side = corners[(i + 2) % 3] - corners[(i + 1) % 3];
    const Complex gradient(-side.imag() / doubleArea, side.real() / doubleArea);
    const Complex ray = p - corners[i];
    const double squaredRay = std::norm(ray);
    Complex value = carried[i];
    if (twist[i] != 0.0 && squaredRay > 0.0) {
      value = towards(i, ray);
      const Complex turning = b[i] * twist[i] / squaredRay * Complex(0.0, 1.0) * value;
      dx -= ray.imag() * turning;
      dy += ray.real() * turning;
    }
    dx += gradient.real() * value;
    dy += gradient.imag() * value;
  }
  Eigen::Matrix2d result;
  result << dx.real(), dy.real(), dx.imag(), dy.imag();
  return result;
}

FaceInterpolant faceInterpolant(const VectorField& field, Index f) {
  return FaceInterpolant(*field.charts, f, cornerValues(field, f));
}

Vec3 evaluate(const VectorField& field, const SurfacePoint& p) {
  const FaceInterpolant local = faceInterpolant(field, p.face);
  return field.charts->faceToSpace(p.face, local.evaluate(local.point(p.barycentric)));
}

Eigen::Matrix2d jacobian(const VectorField& field, const SurfacePoint& p) {
  const FaceInterpolant local = faceInterpolant(field, p.face);
  return local.jacobian(local.point(p.barycentric));
}

}  // namespace stormfield
