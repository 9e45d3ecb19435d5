// The continuous interpolation of a vector field inside a face (thesis 2.5; Zhang, Mischaikow, Turk 2006).
//
// The vector of corner i is carried along the straight line to the query point p: it keeps its chart angle to the line.
// With u_i the vector carried along the corner's own halfedge and phi_i(p) the angle at the corner from that halfedge
// to the line, in the face's flat frame
//     V(p) = sum_i b_i(p) u_i exp(i (1 - scale_i) phi_i(p)).
// On an edge this is the linear blend of the two carried end vectors, the same from both faces; in a flat mesh it is
// linear interpolation.
#pragma once

#include <array>

#include "field/vector_field.h"

namespace stormfield {

/// All that is needed to evaluate a field inside one face, without further look-ups.
struct FaceInterpolant {
  std::array<Complex, 3> corners;  ///< positions of the corners in the flat frame, corner 0 at the origin
  std::array<Complex, 3> carried;  ///< u_i above
  std::array<double, 3> twist;     ///< 1 - scale_i
  double doubleArea = 0.0;

  FaceInterpolant(const VertexCharts& charts, Index f, const std::array<Complex, 3>& vertexValues);

  Complex point(const Eigen::Vector3d& barycentric) const;
  Eigen::Vector3d barycentric(Complex point) const;
  /// Vector at a point of the flat frame (also a little outside the face, where it is the smooth continuation).
  Complex evaluate(Complex point) const;
  /// d(vector)/d(point) in the flat frame, 1/s.
  Eigen::Matrix2d jacobian(Complex point) const;
};

FaceInterpolant faceInterpolant(const VectorField& field, Index f);
/// Vector at a surface point in space, and its Jacobian in the face's flat frame.
Vec3 evaluate(const VectorField& field, const SurfacePoint& p);
Eigen::Matrix2d jacobian(const VectorField& field, const SurfacePoint& p);

}  // namespace stormfield
