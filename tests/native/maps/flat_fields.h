// Linear fields on flat meshes: the interpolation reproduces them, so that their flows have closed forms.
#pragma once

#include <functional>

#include "fixtures.h"
#include "mesh/surface_point.h"

namespace stormfield::test {

/// The field with the given vectors at the vertices of a flat surface in the xy plane.
inline VectorField flatField(const std::shared_ptr<const VertexCharts>& charts,
                             const std::function<Vec3(const Vec3&)>& vectorAt) {
  const TriangleMesh& mesh = charts->mesh();
  Points vectors(mesh.vertexCount(), 3);
  for (Index v = 0; v < mesh.vertexCount(); ++v) vectors.row(v) = vectorAt(mesh.point(v));
  return fromSpace(charts, vectors);
}

/// V(p) = [[a, b], [c, d]] p.
inline VectorField linearField(const std::shared_ptr<const VertexCharts>& charts, double a, double b, double c,
                               double d) {
  return flatField(charts, [=](const Vec3& p) { return Vec3(a * p.x() + b * p.y(), c * p.x() + d * p.y(), 0.0); });
}

/// The barycentric coordinates of a point of the plane in a face.
inline Eigen::Vector3d barycentricIn(const TriangleMesh& mesh, Index f, const Vec3& p) {
  const Vec3 a = mesh.point(mesh.vertex(f, 0)), b = mesh.point(mesh.vertex(f, 1)), c = mesh.point(mesh.vertex(f, 2));
  const double area = (b - a).cross(c - a).z();
  const double ofB = (p - a).cross(c - a).z() / area, ofC = (b - a).cross(p - a).z() / area;
  return {1.0 - ofB - ofC, ofB, ofC};
}

/// The face that holds a point of the plane with its distance from the border above `margin` (barycentric), or kNone.
inline Index faceAt(const TriangleMesh& mesh, const Vec3& p, double margin) {
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    if (barycentricIn(mesh, f, p).minCoeff() > margin) return f;
  }
  return kNone;
}

}  // namespace stormfield::test
