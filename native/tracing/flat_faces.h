// The surface laid out for tracing: every face in its own flat frame, ready to evaluate the continuous interpolation
// (field/interpolation.h, thesis 2.5) of any field on the mesh and to step over its edges.
//
// It holds what depends on the mesh alone, one block per face, so that entering a face costs one look-up of three
// vertex values. The field is split in two:
//     V(p) = sum_i b_i u_i + sum_i b_i u_i (exp(i twist_i psi_i) - 1),
// the linear part in double precision, and the correction for curvature, which is as small as the twist, in single
// precision with polynomials for the arc tangent and the exponential. The error stays below 1e-6 of twist times speed,
// and the result is the same on every processor. Faces with a corner above 160 degrees or a turn above 0.8 radians use
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

  Complex carry(int i, Complex value) const { return value * turn_[i]; }
  CarriedVectors carry(Complex a, Complex b, Complex c) const {
    CarriedVectors u;
    u.exact = {a * turn_[0], b * turn_[1], c * turn_[2]};
    u.x = lanes(u.exact[0].real(), u.exact[1].real(), u.exact[2].real());
    u.y = lanes(u.exact[0].imag(), u.exact[1].imag(), u.exact[2].imag());
    return u;
  }

  /// The field at a point of the frame, also a little outside the face.
  Complex evaluate(const CarriedVectors& u, Complex p) const;

  /// Whether the correction for curvature is zero, and whether it needs the library's functions.
  bool isFlat() const { return shape_ == Shape::Flat; }
  bool isExtreme() const { return shape_ == Shape::Extreme; }
  /// The correction at four points of a face that is not extreme: first, first + 1 and first + 2 (mod 3) are the
  /// corners of the carried vectors u, b0 and b1 the coordinates of the first two.
  std::array<Lanes, 2> corrections(int first, const std::array<Complex, 3>& u, const Lanes& b0, const Lanes& b1) const;

 private:
  enum class Shape : Index { Flat, Regular, Extreme };
  struct Turning {
    Lanes cosineLess1, sine;
  };

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
  /// By how much a corner's vector turns on the line to a point whose distances from the corner, along the next and the
  /// previous side (in the skew axes that these are), are given.
  static Turning turning(const Lanes& alongNext, const Lanes& alongPrevious, const Lanes& tanHalf,
                         const Lanes& doubleTwist);
  Complex evaluateExtreme(const CarriedVectors& u, const std::array<double, 3>& b, Complex p) const;

  double base_, foot_, height_, inverseBase_, inverseHeight_, shear_;
  std::array<Complex, 3> turn_;  ///< unit factor from the vertex chart to the flat frame, along the bisector
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
  const std::shared_ptr<const VertexCharts>& chartsPointer() const { return charts_; }
  const TriangleMesh& mesh() const { return charts_->mesh(); }
  const FlatFace& operator[](Index f) const { return faces_[f]; }
  /// Says that a face will be entered soon.
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

inline FlatFace::Turning FlatFace::turning(const Lanes& alongNext, const Lanes& alongPrevious, const Lanes& tanHalf,
                                           const Lanes& doubleTwist) {
  // Of the line in the frame of the bisector, both divided by the cosine of half the corner angle.
  const Lanes x = alongNext + alongPrevious, y = tanHalf * (alongPrevious - alongNext);
  // Tangent of half the angle to the bisector; behind a corner, where only overshooting steps look, it is clamped.
  const Lanes t = (y / (x + squareRoot(x * x + y * y)).max(1e-30F)).max(-0.84F).min(0.84F);
  const Lanes q = t * t, qq = q * q;
  // Minimax polynomial of the arc tangent up to 40 degrees, Taylor polynomials of sine and cosine up to 0.8.
  const Lanes arcTangent = t * ((0.999995058F - q * 0.333120346F) +
                                qq * ((0.197340058F - q * 0.12811836F) + qq * (0.0682753295F - q * 0.0192904742F)));
  const Lanes angle = doubleTwist * arcTangent, s = angle * angle, ss = s * s;
  return {s * ((s * (1.0F / 24) - 1.0F / 2) + ss * (s * (1.0F / 40320) - 1.0F / 720)),
          angle * ((1.0F - s * (1.0F / 6)) + ss * (1.0F / 120 - s * (1.0F / 5040)))};
}

inline Complex FlatFace::evaluate(const CarriedVectors& u, Complex p) const {
  const Eigen::Vector3d rate = barycentricRate(p);
  const std::array<double, 3> b = {1.0 + rate[0], rate[1], rate[2]};
  if (shape_ == Shape::Extreme) return evaluateExtreme(u, b, p);
  const Complex linear = b[0] * u.exact[0] + b[1] * u.exact[1] + b[2] * u.exact[2];
  if (shape_ == Shape::Flat) return linear;

  const Lanes alongNext = lanes(b[1], b[2], b[0]) * sides_;
  const Lanes alongPrevious = lanes(b[2], b[0], b[1]) * Lanes(sides_[2], sides_[0], sides_[1], 0.0F);
  const Turning turned = turning(alongNext, alongPrevious, tanHalf_, doubleTwist_);
  const Lanes weight = lanes(b[0], b[1], b[2]);
  const float correctionX = (weight * (u.x * turned.cosineLess1 - u.y * turned.sine)).sum();
  const float correctionY = (weight * (u.x * turned.sine + u.y * turned.cosineLess1)).sum();
  return {linear.real() + static_cast<double>(correctionX), linear.imag() + static_cast<double>(correctionY)};
}

inline std::array<FlatFace::Lanes, 2> FlatFace::corrections(int first, const std::array<Complex, 3>& u, const Lanes& b0,
                                                            const Lanes& b1) const {
  const std::array<Lanes, 3> b = {b0, b1, 1.0F - b0 - b1};
  std::array<Lanes, 2> sum = {Lanes::Zero(), Lanes::Zero()};
  for (int k = 0, i = first; k < 3; ++k, i = i == 2 ? 0 : i + 1) {
    const Turning turned =
        turning(b[k == 2 ? 0 : k + 1] * sides_[i], b[k == 0 ? 2 : k - 1] * sides_[i == 0 ? 2 : i - 1],
                Lanes::Constant(tanHalf_[i]), Lanes::Constant(doubleTwist_[i]));
    const auto ux = static_cast<float>(u[k].real()), uy = static_cast<float>(u[k].imag());
    sum[0] += b[k] * (ux * turned.cosineLess1 - uy * turned.sine);
    sum[1] += b[k] * (ux * turned.sine + uy * turned.cosineLess1);
  }
  return sum;
}

}  // namespace stormfield
