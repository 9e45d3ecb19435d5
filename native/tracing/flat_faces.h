// The surface laid out for tracing: every face in its own flat frame, ready to evaluate the continuous interpolation
// (field/interpolation.h, thesis 2.5) of any field on the mesh and to step over its edges.
//
// It holds what depends on the mesh alone, one block per face, so that entering a face costs one look-up of three
// vertex values. The field is split in two:
//     V(p) = sum_i b_i u_i + sum_i b_i u_i (exp(i twist_i psi_i) - 1),
// the linear part in double precision, and the correction for curvature, which is as small as the twist, in single
// precision with polynomials for the arc tangent and the exponential. The error stays below 1e-6 of twist times speed,
// and the result is the same on every processor. Faces with a corner above 120 degrees or a turn above 0.8 radians use
// the library's functions.
//
//   const FlatFaces faces(charts);
//   const FlatFace& face = faces[f];
//   const Complex v = face.evaluate(face.carry(values), p);            // p and v in the flat frame of f
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "mesh/surface_point.h"
#include "mesh/vertex_charts.h"

namespace stormfield {

/// The three vertex vectors of a face, carried along the bisectors of their corners into the flat frame. A real-linear
/// function of the vertex values, so that blending in lambda may be done before or after.
struct CarriedVectors {
  std::array<Complex, 3> exact;
  Eigen::Array4f x, y;  ///< the same, one lane per corner; the fourth is zero

  /// this + factor * other
  CarriedVectors plus(double factor, const CarriedVectors& other) const {
    const auto f = static_cast<float>(factor);
    return {
        {exact[0] + factor * other.exact[0], exact[1] + factor * other.exact[1], exact[2] + factor * other.exact[2]},
        x + f * other.x,
        y + f * other.y};
  }
};

/// One face: corner 0 at the origin, corner 1 on the positive x axis, interior above.
class alignas(64) FlatFace {
 public:
  FlatFace() = default;
  FlatFace(const VertexCharts& charts, Index f);

  /// Vertex at a corner, and the halfedge opposite to halfedge i of this face (kNone on the boundary).
  Index vertex(int corner) const { return vertices_[corner]; }
  Index twin(int side) const { return twins_[side]; }

  Complex corner(int i) const { return {cornerX_[i], cornerY_[i]}; }
  Complex point(const Eigen::Vector3d& b) const {
    return {b[1] * cornerX_[1] + b[2] * cornerX_[2], b[2] * cornerY_[2]};
  }
  Eigen::Vector3d barycentric(Complex p) const {
    const Eigen::Vector3d rate = barycentricRate(p);
    return {1.0 + rate[0], rate[1], rate[2]};
  }
  /// Change of the barycentric coordinates along a vector.
  Eigen::Vector3d barycentricRate(Complex v) const {
    const double b2 = v.imag() * inverseHeight();
    const double b1 = (v.real() - b2 * cornerX_[2]) * inverseBase();
    return {-b1 - b2, b1, b2};
  }

  CarriedVectors carry(Complex a, Complex b, Complex c) const {
    CarriedVectors u;
    u.exact = {a * turn_[0], b * turn_[1], c * turn_[2]};
    u.x = lanes(u.exact[0].real(), u.exact[1].real(), u.exact[2].real());
    u.y = lanes(u.exact[0].imag(), u.exact[1].imag(), u.exact[2].imag());
    return u;
  }

  /// The field at a point of the frame, also a little outside the face.
  Complex evaluate(const CarriedVectors& u, Complex p) const;

 private:
  enum class Shape : Index { Flat, Regular, Extreme };
  using Lanes = Eigen::Array4f;

  static Lanes lanes(double a, double b, double c) {
    return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), 0.0F};
  }
  /// Correctly rounded on every processor, unlike the library's, which starts from the processor's estimate.
  static Lanes squareRoot(const Lanes& a) {
    Lanes root;
#ifdef __SSE__
    _mm_store_ps(root.data(), _mm_sqrt_ps(_mm_load_ps(a.data())));
#else
    for (int i = 0; i < 4; ++i) root[i] = std::sqrt(a[i]);
#endif
    return root;
  }
  // The fourth lanes of the corners hold the reciprocals of base and height.
  double inverseBase() const {
    return cornerX_[3];
  }
  double inverseHeight() const {
    return cornerY_[3];
  }
  Complex evaluateExtreme(const CarriedVectors& u, const std::array<double, 3>& b, Complex p) const;

  Eigen::Array4d cornerX_, cornerY_;
  std::array<Complex, 3> turn_;  ///< unit factor from the vertex chart to the flat frame, along the bisector
  Lanes bisectorX_, bisectorY_;  ///< divided by the base, so that no scale of mesh leaves single precision
  Lanes doubleTwist_;            ///< 2 (1 - scale): the angle below is half the angle to the bisector
  std::array<Index, 3> vertices_, twins_;
  Shape shape_ = Shape::Flat;
};

class FlatFaces {
 public:
  explicit FlatFaces(std::shared_ptr<const VertexCharts> charts);

  const VertexCharts& charts() const { return *charts_; }
  const std::shared_ptr<const VertexCharts>& chartsPointer() const { return charts_; }
  const TriangleMesh& mesh() const { return charts_->mesh(); }
  const FlatFace& operator[](Index f) const { return faces_[f]; }

 private:
  std::shared_ptr<const VertexCharts> charts_;
  std::vector<FlatFace> faces_;
};

// Inline: the inner loop of all tracers ------------------------------------------------------------------------------

inline Complex FlatFace::evaluate(const CarriedVectors& u, Complex p) const {
  const double b2 = p.imag() * inverseHeight();
  const double b1 = (p.real() - b2 * cornerX_[2]) * inverseBase();
  const std::array<double, 3> b = {1.0 - b1 - b2, b1, b2};
  if (shape_ == Shape::Extreme) return evaluateExtreme(u, b, p);
  const Complex linear = b[0] * u.exact[0] + b[1] * u.exact[1] + b[2] * u.exact[2];
  if (shape_ == Shape::Flat) return linear;

  const Lanes dx = (p.real() - cornerX_).cast<float>(), dy = (p.imag() - cornerY_).cast<float>();
  const Lanes x = dx * bisectorX_ + dy * bisectorY_, y = dy * bisectorX_ - dx * bisectorY_;
  // Tangent of half the angle to the bisector; behind a corner, where only overshooting steps look, it is clamped.
  const Lanes t = (y / (x + squareRoot(x * x + y * y)).max(1e-30F)).max(-0.7F).min(0.7F);
  const Lanes q = t * t, qq = q * q;
  // Minimax polynomial of the arc tangent up to 30 degrees, Taylor polynomials of sine and cosine up to 0.8.
  const Lanes arcTangent =
      t * ((0.999999635F - q * 0.333276988F) + qq * ((0.198587589F - q * 0.130086581F) + qq * 0.060380120F));
  const Lanes angle = doubleTwist_ * arcTangent, s = angle * angle, ss = s * s;
  const Lanes cosineLess1 = s * ((s * (1.0F / 24) - 1.0F / 2) + ss * (s * (1.0F / 40320) - 1.0F / 720));
  const Lanes sine = angle * ((1.0F - s * (1.0F / 6)) + ss * (1.0F / 120 - s * (1.0F / 5040)));
  const Lanes weight = lanes(b[0], b[1], b[2]);
  const float correctionX = (weight * (u.x * cosineLess1 - u.y * sine)).sum();
  const float correctionY = (weight * (u.x * sine + u.y * cosineLess1)).sum();
  return {linear.real() + static_cast<double>(correctionX), linear.imag() + static_cast<double>(correctionY)};
}

}  // namespace stormfield
