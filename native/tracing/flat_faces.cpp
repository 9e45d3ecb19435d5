#include "tracing/flat_faces.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <utility>

#include "field/interpolation.h"

namespace stormfield {
namespace {

/// Limits of the polynomials: the corner angle, and the largest rotation against the bisector, radians.
constexpr double kMaxCorner = 2.792526803190927;
constexpr double kMaxRotation = 0.8;

}  // namespace

FlatFace::FlatFace(const VertexCharts& charts, Index f) {
  const TriangleMesh& mesh = charts.mesh();
  const FaceInterpolant unit(charts, f, {1.0, 1.0, 1.0});
  base_ = unit.corners[1].real();
  foot_ = unit.corners[2].real();
  height_ = unit.corners[2].imag();
  inverseBase_ = 1.0 / base_;
  inverseHeight_ = 1.0 / height_;
  shear_ = -foot_ * inverseBase_ * inverseHeight_;
  tanHalf_.setZero();
  doubleTwist_.setZero();
  for (int i = 0; i < 3; ++i) {
    const Index h = TriangleMesh::halfedge(f, i);
    vertices_[i] = mesh.vertex(f, i);
    twins_[i] = mesh.twin(h);
    toFlat_[i] = unit.carried[i];
    const double cornerAngle = mesh.cornerAngle(h);
    sides_[i] = static_cast<float>(mesh.edgeLength(mesh.edge(h)) / base_);
    tanHalf_[i] = static_cast<float>(std::tan(0.5 * cornerAngle));
    doubleTwist_[i] = static_cast<float>(2.0 * unit.twist[i]);
    if (unit.twist[i] == 0.0) continue;
    const bool regular = cornerAngle < kMaxCorner && std::abs(unit.twist[i]) * 0.5 * cornerAngle < kMaxRotation;
    shape_ = regular ? (shape_ == Shape::Extreme ? shape_ : Shape::Regular) : Shape::Extreme;
  }
  sides_[3] = sides_.head<3>().maxCoeff();
  static_assert(sizeof(FlatFace) == 192, "a face fills three cache lines");
}

Complex FlatFace::evaluateExtreme(const CarriedVectors& u, const std::array<double, 3>& b, Complex p) const {
  Complex sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    // Half the angle between the two sides, less that between the next side and the line.
    const Complex ray = (p - corner(i)) * std::conj(corner((i + 1) % 3) - corner(i));
    const Complex bisector(1.0, static_cast<double>(tanHalf_[i]));
    const Complex local = ray * std::conj(bisector);
    const double angle = 0.5 * static_cast<double>(doubleTwist_[i]) * std::atan2(local.imag(), local.real());
    sum += b[i] * u.exact[i] * Complex(std::cos(angle), std::sin(angle));
  }
  return sum;
}

FlatFaces::FlatFaces(std::shared_ptr<const VertexCharts> charts)
    : charts_(std::move(charts)), faces_(static_cast<std::size_t>(mesh().faceCount())) {
  tbb::parallel_for(Index{0}, mesh().faceCount(), [&](Index f) { faces_[f] = FlatFace(*charts_, f); });
}

}  // namespace stormfield
