#include "tracing/flat_faces.h"

#include <tbb/parallel_for.h>

#include <utility>

#include "field/interpolation.h"

namespace stormfield {
namespace {

/// Limits of the polynomials: the corner angle, and the largest turn against the bisector, radians.
constexpr double kWidestCorner = 2.0943951023931953;
constexpr double kLargestTurn = 0.8;

}  // namespace

FlatFace::FlatFace(const VertexCharts& charts, Index f) {
  const TriangleMesh& mesh = charts.mesh();
  const FaceInterpolant unit(charts, f, {1.0, 1.0, 1.0});
  cornerX_.setZero();
  cornerY_.setZero();
  bisectorX_.setZero();
  bisectorY_.setZero();
  doubleTwist_.setZero();
  const double base = unit.corners[1].real();
  for (int i = 0; i < 3; ++i) {
    const Index h = TriangleMesh::halfedge(f, i);
    vertices_[i] = mesh.vertex(f, i);
    twins_[i] = mesh.twin(h);
    cornerX_[i] = unit.corners[i].real();
    cornerY_[i] = unit.corners[i].imag();
    bisectorX_[i] = static_cast<float>(unit.bisector[i].real() / base);
    bisectorY_[i] = static_cast<float>(unit.bisector[i].imag() / base);
    doubleTwist_[i] = static_cast<float>(2.0 * unit.twist[i]);
    turn_[i] = unit.carried[i];
    const double cornerAngle = mesh.cornerAngle(h);
    if (unit.twist[i] == 0.0) continue;
    const bool regular = cornerAngle < kWidestCorner && std::abs(unit.twist[i]) * 0.5 * cornerAngle < kLargestTurn;
    shape_ = regular ? (shape_ == Shape::Extreme ? shape_ : Shape::Regular) : Shape::Extreme;
  }
  static_assert(sizeof(FlatFace) == 192, "a face fills three cache lines");
  cornerX_[3] = 1.0 / cornerX_[1];
  cornerY_[3] = 1.0 / cornerY_[2];
}

Complex FlatFace::evaluateExtreme(const CarriedVectors& u, const std::array<double, 3>& b, Complex p) const {
  Complex sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Complex ray = (p - corner(i)) * Complex(bisectorX_[i], -bisectorY_[i]);
    const double angle = 0.5 * doubleTwist_[i] * std::atan2(ray.imag(), ray.real());
    sum += b[i] * u.exact[i] * Complex(std::cos(angle), std::sin(angle));
  }
  return sum;
}

FlatFaces::FlatFaces(std::shared_ptr<const VertexCharts> charts)
    : charts_(std::move(charts)), faces_(static_cast<std::size_t>(mesh().faceCount())) {
  tbb::parallel_for(Index{0}, mesh().faceCount(), [&](Index f) { faces_[f] = FlatFace(*charts_, f); });
}

}  // namespace stormfield
