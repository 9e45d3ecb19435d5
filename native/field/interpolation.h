// The continuous interpolation of a vector field inside a face (thesis 2.5; Zhang, Mischaikow, Turk 2006).
//
// The vector of corner i is carried along the straight line to the query point p: it keeps its chart angle to the line.
// With u_i the vector carried along the corner's bisector and psi_i(p) the angle at the corner from the bisector to the
// line, in the face's flat frame
//     V(p) = sum_i b_i(p) u_i exp(i twist_i psi_i(p)),   twist_i = 1 - scale_i.
// On an edge this is the linear blend of the two carried end vectors, the same from both faces; in a flat mesh it is
// linear interpolation. At a corner itself the limit depends on the direction of approach: evaluate gives the one
// along the bisector.
//
//   const FaceInterpolant local = faceInterpolant(field, f);
//   const Complex v = local.evaluate(local.point(p.barycentric));  // flat frame of the face, mesh units per second
#pragma once

#include <array>
#include <cmath>

#include "field/vector_field.h"

namespace stormfield {

/// What evaluates a field inside one face, without access to the mesh.
struct FaceInterpolant {
  std::array<Complex, 3> corners;   ///< positions of the corners in the flat frame, corner 0 at the origin
  std::array<Complex, 3> bisector;  ///< unit direction at the corner into the face, halfway between its edges
  std::array<Complex, 3> carried;   ///< u_i above
  std::array<double, 3> twist;      ///< 1 - scale_i; exactly 0 at flat and boundary vertices
  double doubleArea = 0.0;

  FaceInterpolant(const VertexCharts& charts, Index f, const std::array<Complex, 3>& vertexValues);

  Complex point(const Eigen::Vector3d& barycentric) const;
  Eigen::Vector3d barycentric(Complex point) const;
  /// Vector at a point of the flat frame (also a little outside the face, where it is the smooth continuation).
  Complex evaluate(Complex point) const;
  /// d(vector)/d(point) in the flat frame, 1/s.
  Eigen::Matrix2d jacobian(Complex point) const;
  /// The corner's vector as carried along a ray that starts there (any length but 0).
  Complex towards(int corner, Complex ray) const;
};

FaceInterpolant faceInterpolant(const VectorField& field, Index f);
/// Vector at a surface point in space, and its Jacobian in the face's flat frame. The point must lie in the mesh.
Vec3 evaluate(const VectorField& field, const SurfacePoint& p);
Eigen::Matrix2d jacobian(const VectorField& field, const SurfacePoint& p);

// Inline: the inner loop of all tracers ------------------------------------------------------------------------------

inline Complex FaceInterpolant::point(const Eigen::Vector3d& b) const {
  return b[0] * corners[0] + b[1] * corners[1] + b[2] * corners[2];
}

inline Eigen::Vector3d FaceInterpolant::barycentric(Complex p) const {
  const double b1 = (p.real() * corners[2].imag() - p.imag() * corners[2].real()) / doubleArea;
  const double b2 = (corners[1].real() * p.imag() - corners[1].imag() * p.real()) / doubleArea;
  return {1.0 - b1 - b2, b1, b2};
}

inline Complex FaceInterpolant::towards(int i, Complex ray) const {
  if (twist[i] == 0.0) return carried[i];
  const Complex local = ray * std::conj(bisector[i]);
  const double angle = twist[i] * std::atan2(local.imag(), local.real());
  const double square = angle * angle;
  // The twist of a smooth mesh is small: the series to the sixth order is then exact to round-off.
  if (square < 1e-4) {
    const double cosine = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square / 720.0));
    const double sine = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square / 5040.0)));
    return carried[i] * Complex(cosine, sine);
  }
  return carried[i] * Complex(std::cos(angle), std::sin(angle));
}

inline Complex FaceInterpolant::evaluate(Complex p) const {
  const Eigen::Vector3d b = barycentric(p);
  Complex sum = 0.0;
  for (int i = 0; i < 3; ++i) sum += b[i] * towards(i, p - corners[i]);
  return sum;
}

}  // namespace stormfield
