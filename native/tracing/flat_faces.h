// The surface laid out for tracing: every face in its own flat frame, ready to evaluate the continuous interpolation
// (field/interpolation.h, thesis 2.5) of any field on the mesh and to step over its edges.
//
// It holds what depends on the mesh alone, one block per face, so that entering a face reads three vertex
// values only. The field is split in two:
//     V(p) = sum_i b_i u_i + sum_i b_i u_i (exp(i twist_i psi_i) - 1),
// the linear part in double precision, and the correction for curvature, which is as small as the twist, in single
// precision with polynomials for the arc tangent and the exponential. The error stays below 1e-6 of twist times speed,
// and the result is the same on every processor. Faces with a corner above 160 degrees or a rotation above 0.8 radians
// use the library's functions.
//
//   const FlatFaces faces(charts);
//   const FlatFace& face = faces[f];
//   const CarriedVectors u = face.carry(values[face.vertex(0)], values[face.vertex(1)], values[face.vertex(2)]);
//   const Complex v = face.evaluate(u, face.point(p.barycentric));  // in the flat frame of f
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
#include "tracing/detail/small_rotation.h"

namespace stormfield {

/// The three vertex vectors of a face, carried along the bisectors of their corners into the flat frame. A real-linear
/// function of the vertex values, so that blending in lambda may be done before or after.
struct CarriedVectors {
  std::array<Complex, 3> exact;
  Eigen::Array4f x = Eigen::Array4f::Zero(),
                 y = Eigen::Array4f::Zero();  ///< the same, one lane per corner; the fourth is zero

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
  using Lanes = Eigen::Array4f;

  FlatFace() = default;
  FlatFace(const VertexCharts& charts, Index f);

  /// Vertex at a corner, and the halfedge opposite to halfedge i of this face (kNone on the boundary).
  Index vertex(int corner) const { return vertices_[corner]; }
  Index twin(int side) const { return twins_[side]; }

  Complex corner(int i) const { return {i == 0 ? 0.0 : (i == 1 ? base_ : foot_), i == 2 ? height_ : 0.0}; }
  Complex point(const Eigen::Vector3d& b) const { return {b[1] * base_ + b[2] * foot_, b[2] * height_}; }
  Eigen::Vector3d barycentric(Complex p) const {
    const Eigen::Vector3d rate = barycentricRate(p);
    return {1.0 + rate[0], rate[1], rate[2]};
  }
  /// Change of the barycentric coordinates along a vector.
  Eigen::Vector3d barycentricRate(Complex v) const {
    const double b2 = v.imag() * inverseHeight_;
    const double b1 = v.real() * inverseBase_ + v.imag() * shear_;
    return {-b1 - b2, b1, b2};
  }
  /// Gradient of a corner's barycentric coordinate.
  Complex gradient(int i) const {
    return {i == 0 ? -inverseBase_ : (i == 1 ? inverseBase_ : 0.0),
            i == 0 ? -shear_ - inverseHeight_ : (i == 1 ? shear_ : inverseHeight_)};
  }
  double longestSide() const { return base_ * static_cast<double>(sides_[3]); }
  /// 2 (1 - scale) of a corner, and the tangent of half its angle.
  float doubleTwist(int corner) const { return doubleTwist_[corner]; }
  float tanHalf(int corner) const { return tanHalf_[corner]; }

  Complex carry(int i, Complex value) const { return value * toFlat_[i]; }
  CarriedVectors carry(Complex a, Complex b, Complex c) const {
    CarriedVectors u;
    u.exact = {a * toFlat_[0], b * toFlat_[1], c * toFlat_[2]};
    u.x = lanes(u.exact[0].real(), u.exact[1].real(), u.exact[2].real());
    u.y = lanes(u.exact[0].imag(), u.exact[1].imag(), u.exact[2].imag());
    return u;
  }

  /// The field at a point of the frame, also a little outside the face.
  Complex evaluate(const CarriedVectors& u, Complex p) const;

  /// Whether the correction for curvature needs the library's functions.
  bool isExtreme() const { return shape_ == Shape::Extreme; }

 private:
  enum class Shape : Index { Flat, Regular, Extreme };
  using Rotation = lanes::SmallRotation<Lanes>;

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
  /// Rotation of a corner's vector on the line to a point whose distances from the corner, along the next and the
  /// previous side (its skew coordinates), are given.
  static Rotation twistRotation(const Lanes& alongNext, const Lanes& alongPrevious, const Lanes& tanHalf,
                                const Lanes& doubleTwist);
  Complex evaluateExtreme(const CarriedVectors& u, const std::array<double, 3>& b, Complex p) const;

  double base_, foot_, height_, inverseBase_, inverseHeight_, shear_;
  std::array<Complex, 3> toFlat_;  ///< unit factor from the vertex chart to the flat frame, along the bisector
  Lanes sides_;  ///< lengths divided by the base, so that no scale of mesh leaves single precision; [3] is the longest
  Lanes tanHalf_;      ///< tangent of half the corner angle
  Lanes doubleTwist_;  ///< 2 (1 - scale): the angle below is half the angle to the bisector
  std::array<Index, 3> vertices_, twins_;
  Shape shape_ = Shape::Flat;
};

class FlatFaces {
 public:
  explicit FlatFaces(std::shared_ptr<const VertexCharts> charts);

  const VertexCharts& charts() const { return *charts_; }
  const TriangleMesh& mesh() const { return charts_->mesh(); }
  const FlatFace& operator[](Index f) const { return faces_[f]; }
  /// Loads a face that will be entered soon into the cache.
  void prefetch(Index f) const {
#ifdef __GNUC__
    const char* face = reinterpret_cast<const char*>(&faces_[f]);
    for (std::size_t line = 0; line < sizeof(FlatFace); line += 64) __builtin_prefetch(face + line);
#else
    static_cast<void>(f);
#endif
  }

 private:
  std::shared_ptr<const VertexCharts> charts_;
  std::vector<FlatFace> faces_;
};

// Inline: the inner loop of all tracers ------------------------------------------------------------------------------

inline FlatFace::Rotation FlatFace::twistRotation(const Lanes& alongNext, const Lanes& alongPrevious,
                                                  const Lanes& tanHalf, const Lanes& doubleTwist) {
  // Of the line in the frame of the bisector, both divided by the cosine of half the corner angle.
  const Lanes x = alongNext + alongPrevious, y = tanHalf * (alongPrevious - alongNext);
  // Tangent of half the angle to the bisector; behind a corner, where only overshooting steps evaluate, it is clamped.
  const Lanes t = (y / (x + squareRoot(x * x + y * y)).max(1e-30F)).max(-lanes::kMaxTangent).min(lanes::kMaxTangent);
  return lanes::smallRotation(Lanes(doubleTwist * lanes::arcTangent(t)));
}

inline Complex FlatFace::evaluate(const CarriedVectors& u, Complex p) const {
  const Eigen::Vector3d rate = barycentricRate(p);
  const std::array<double, 3> b = {1.0 + rate[0], rate[1], rate[2]};
  if (shape_ == Shape::Extreme) return evaluateExtreme(u, b, p);
  const Complex linear = b[0] * u.exact[0] + b[1] * u.exact[1] + b[2] * u.exact[2];
  if (shape_ == Shape::Flat) return linear;

  const Lanes alongNext = lanes(b[1], b[2], b[0]) * sides_;
  const Lanes alongPrevious = lanes(b[2], b[0], b[1]) * Lanes(sides_[2], sides_[0], sides_[1], 0.0F);
  const Rotation rotation = twistRotation(alongNext, alongPrevious, tanHalf_, doubleTwist_);
  const Lanes weight = lanes(b[0], b[1], b[2]);
  const float correctionX = (weight * (u.x * rotation.cosineLess1 - u.y * rotation.sine)).sum();
  const float correctionY = (weight * (u.x * rotation.sine + u.y * rotation.cosineLess1)).sum();
  return {linear.real() + static_cast<double>(correctionX), linear.imag() + static_cast<double>(correctionY)};
}

}  // namespace stormfield
