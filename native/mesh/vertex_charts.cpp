#include "mesh/vertex_charts.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3 alongHalfedge(const TriangleMesh& mesh, Index h) {
  return mesh.point(mesh.head(h)) - mesh.point(mesh.tail(h));
}

/// Mean of the normals of the faces around v, weighted by their corner angles.
Vec3 vertexNormal(const TriangleMesh& mesh, Index v) {
  Vec3 sum = Vec3::Zero();
  for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
    sum += mesh.cornerAngle(h) * mesh.faceNormal(TriangleMesh::face(h));
  }
  // Faces that cancel each other (a fold) leave no mean; any face's normal is then as good as another.
  const double length = sum.norm();
  return length > 1e-9 ? Vec3(sum / length) : mesh.faceNormal(TriangleMesh::face(mesh.outgoing(v)));
}

}  // namespace

VertexCharts::VertexCharts(std::shared_ptr<const TriangleMesh> mesh) : mesh_(std::move(mesh)) {
  const TriangleMesh& m = *mesh_;
  scale_.assign(m.vertexCount(), 1.0);
  totalAngle_.assign(m.vertexCount(), 0.0);
  tailAngle_.resize(m.halfedgeCount());
  headAngle_.resize(m.halfedgeCount());
  faceAngle_.resize(m.halfedgeCount());
  transport_.resize(m.halfedgeCount());
  normals_.resize(m.vertexCount(), 3);
  xAxes_.resize(m.vertexCount(), 3);

  tbb::parallel_for(Index{0}, m.vertexCount(), [&](Index v) { measureAngles(v); });
  tbb::parallel_for(Index{0}, m.edgeCount(), [&](Index e) { connect(m.edgeHalfedge(e)); });
  tbb::parallel_for(Index{0}, m.vertexCount(), [&](Index v) { placeFrame(v); });
  tbb::parallel_for(Index{0}, m.faceCount(), [&](Index f) {
    const double toSecond = kPi - m.cornerAngle(3 * f + 1);
    faceAngle_[3 * f] = 0.0;
    faceAngle_[3 * f + 1] = toSecond;
    faceAngle_[3 * f + 2] = m.cornerAngle(3 * f) - kPi;
  });
}

void VertexCharts::measureAngles(Index v) {
  const TriangleMesh& m = *mesh_;
  if (m.outgoing(v) == kNone) return;
  for (Index h = m.outgoing(v); h != kNone; h = m.nextOutgoing(h)) {
    tailAngle_[h] = totalAngle_[v];
    totalAngle_[v] += m.cornerAngle(h);
  }
  if (m.isBoundaryVertex(v)) return;
  scale_[v] = 2.0 * kPi / totalAngle_[v];
  for (Index h = m.outgoing(v); h != kNone; h = m.nextOutgoing(h)) tailAngle_[h] *= scale_[v];
}

void VertexCharts::connect(Index h) {
  const TriangleMesh& m = *mesh_;
  const Index t = m.twin(h);
  // The direction back at the head is that of the twin; at a boundary it is the far side of the head's last face.
  const Index onward = TriangleMesh::next(h);
  const double back = t != kNone ? tailAngle_[t] : tailAngle_[onward] + scale_[m.head(h)] * m.cornerAngle(onward);
  headAngle_[h] = back + kPi;
  transport_[h] = std::polar(1.0, headAngle_[h] - tailAngle_[h]);
  if (t == kNone) return;
  headAngle_[t] = tailAngle_[h] + kPi;
  transport_[t] = std::conj(transport_[h]);
}

void VertexCharts::placeFrame(Index v) {
  const TriangleMesh& m = *mesh_;
  if (m.outgoing(v) == kNone) {
    normals_.row(v) = Vec3::UnitZ();
    xAxes_.row(v) = Vec3::UnitX();
    return;
  }
  const Vec3 normal = vertexNormal(m, v);
  Vec3 x = alongHalfedge(m, m.outgoing(v));
  x -= normal * normal.dot(x);
  if (x.squaredNorm() < 1e-24 * m.edgeLength(m.edge(m.outgoing(v))) * m.edgeLength(m.edge(m.outgoing(v)))) {
    x = normal.unitOrthogonal();
  }
  x.normalize();
  const Vec3 y = normal.cross(x);

  // Rotate the frame by the mean of (projected angle - chart angle) over the edges.
  Complex sum = 0.0;
  const auto add = [&](const Vec3& direction, double chartAngle) {
    const Complex projected(direction.dot(x), direction.dot(y));
    const double length = std::abs(projected);
    if (length > 0.0) sum += projected / length * std::polar(1.0, -chartAngle);
  };
  for (Index h = m.outgoing(v); h != kNone; h = m.nextOutgoing(h)) {
    add(alongHalfedge(m, h), tailAngle_[h]);
    const Index in = TriangleMesh::prev(h);
    if (m.twin(in) == kNone) add(-alongHalfedge(m, in), tailAngle_[h] + m.cornerAngle(h));
  }
  const double length = std::abs(sum);
  if (length > 0.0)
    sum /= length;
  else
    sum = 1.0;
  normals_.row(v) = normal;
  xAxes_.row(v) = sum.real() * x + sum.imag() * y;
}

Vec3 VertexCharts::faceToSpace(Index f, Complex a) const {
  const Vec3 x = alongHalfedge(*mesh_, TriangleMesh::halfedge(f, 0)).normalized();
  return a.real() * x + a.imag() * mesh_->faceNormal(f).cross(x);
}

Complex VertexCharts::spaceToFace(Index f, const Vec3& a) const {
  const Vec3 x = alongHalfedge(*mesh_, TriangleMesh::halfedge(f, 0)).normalized();
  return {a.dot(x), a.dot(mesh_->faceNormal(f).cross(x))};
}

}  // namespace stormfield
