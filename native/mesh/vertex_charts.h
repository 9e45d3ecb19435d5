// Polar charts of the vertices and the transport of tangent vectors between them (thesis 2.5; Zhang et al. 2006).
//
// Around vertex v the directions are measured by a geodesic polar angle, counter-clockwise from the first outgoing
// halfedge: corner angles are multiplied by scale(v) = 2 pi / (sum of corner angles) at an interior vertex, 1 at a
// boundary vertex. A tangent vector at v is a Complex in this chart. A face's own flat frame has its x axis along
// halfedge 3 f. Carrying a vector along an edge keeps its angle to the edge.
#pragma once

#include <memory>

#include "mesh/triangle_mesh.h"

namespace stormfield {

class VertexCharts {
 public:
  explicit VertexCharts(std::shared_ptr<const TriangleMesh> mesh);

  const TriangleMesh& mesh() const { return *mesh_; }
  const std::shared_ptr<const TriangleMesh>& meshPointer() const { return mesh_; }

  double scale(Index v) const { return scale_[v]; }
  /// Sum of the corner angles at v, radians.
  double totalAngle(Index v) const { return totalAngle_[v]; }
  /// Chart angle at tail(h) of the direction along h.
  double tailAngle(Index h) const { return tailAngle_[h]; }
  /// Chart angle at head(h) of the direction along h (pointing on, away from the tail).
  double headAngle(Index h) const { return headAngle_[h]; }
  /// Unit factor that carries a vector at tail(h) along h to head(h): V_head = transport(h) * V_tail.
  Complex transport(Index h) const { return transport_[h]; }
  /// Angle, in the flat frame of face(h), of the direction along h.
  double faceAngle(Index h) const { return faceAngle_[h]; }

  /// Orthonormal frame of the tangent plane in space; the x axis is rotated so that chart angles fit the projected
  /// edge directions best (least squares). Unused vertices get an arbitrary frame.
  Vec3 normal(Index v) const { return normals_.row(v); }
  Vec3 xAxis(Index v) const { return xAxes_.row(v); }
  Vec3 yAxis(Index v) const { return normal(v).cross(xAxis(v)); }
  const Points& normals() const { return normals_; }

  /// Tangent vector <-> vector in space; toTangent drops the normal component.
  Vec3 toSpace(Index v, Complex a) const { return a.real() * xAxis(v) + a.imag() * yAxis(v); }
  Complex toTangent(Index v, const Vec3& a) const { return {a.dot(xAxis(v)), a.dot(yAxis(v))}; }
  /// Vector in the flat frame of a face -> vector in space, and back.
  Vec3 faceToSpace(Index f, Complex a) const;
  Complex spaceToFace(Index f, const Vec3& a) const;

 private:
  void measureAngles(Index v);
  void connect(Index canonicalHalfedge);
  void placeFrame(Index v);

  std::shared_ptr<const TriangleMesh> mesh_;
  std::vector<double> scale_, totalAngle_, tailAngle_, headAngle_, faceAngle_;
  std::vector<Complex> transport_;
  Points normals_, xAxes_;
};

}  // namespace stormfield
