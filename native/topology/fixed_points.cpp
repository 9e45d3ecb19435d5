#include "topology/fixed_points.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "field/poincare_index.h"
#include "topology/detail/separatrix_directions.h"
#include "topology/zero_search.h"

namespace stormfield {
namespace {

FixedPoint locate(const VectorField& field, Index f, int index) {
  const FaceInterpolant local = faceInterpolant(field, f);
  FixedPoint result;
  result.point = {f, findZero(local, index)};
  result.position = position(field.mesh(), result.point);
  result.index = index;
  result.jacobian = local.jacobian(local.point(result.point.barycentric));
  result.rotation = result.jacobian(1, 0) - result.jacobian(0, 1);
  return result;
}

void addEigenvectors(const VertexCharts& charts, FixedPoint& p) {
  const double half = 0.5 * p.jacobian.trace(), det = p.jacobian.determinant();
  const double discriminant = half * half - det;
  if (discriminant < 0.0) {
    const double frequency = std::sqrt(-discriminant);
    p.eigenvalues = {Complex(half, frequency), Complex(half, -frequency)};
    return;
  }
  // The eigenvalue of larger size first, the other from their product: neither sum cancels (Higham 2002, section 1.8).
  const double large = half + std::copysign(std::sqrt(discriminant), half);
  const double small = large == 0.0 ? 0.0 : det / large;
  p.eigenvalues = {std::max(large, small), std::min(large, small)};
  for (int i = 0; i < 2; ++i) {
    // By Cayley and Hamilton both columns of J - (the other eigenvalue) lie along the eigenvector; the longer one is
    // exact.
    const Eigen::Matrix2d along = p.jacobian - p.eigenvalues[1 - i].real() * Eigen::Matrix2d::Identity();
    const int column = along.col(0).squaredNorm() >= along.col(1).squaredNorm() ? 0 : 1;
    const Complex vector(along(0, column), along(1, column));
    const Complex direction =
        vector == 0.0 ? Complex(i == 0 ? 1.0 : 0.0, i == 0 ? 0.0 : 1.0) : vector / std::abs(vector);
    p.eigenvectors[i] = charts.faceToSpace(p.point.face, direction);
  }
}

/// The vertex whose zero vector is this fixed point, or kNone.
Index zeroVertex(const VectorField& field, const SurfacePoint& p) {
  if (p.barycentric.maxCoeff() < 1.0) return kNone;
  const Index v = nearestVertex(field.mesh(), p);
  return field.values[v] == 0.0 ? v : kNone;
}

/// Several faces around a vertex share its zero: one fixed point with the sum of their indices, placed in the first
/// face whose own index has the sum's sign (its Jacobian is then typical).
std::vector<FixedPoint> mergedAtVertices(const VectorField& field, const std::vector<FixedPoint>& found) {
  std::unordered_map<Index, int> sums;
  for (const FixedPoint& p : found) {
    const Index v = zeroVertex(field, p.point);
    if (v != kNone) sums[v] += p.index;
  }
  std::vector<FixedPoint> result;
  result.reserve(found.size());
  for (const FixedPoint& p : found) {
    const Index v = zeroVertex(field, p.point);
    result.push_back(p);
    if (v == kNone) continue;
    int& sum = sums[v];
    if (sum * p.index <= 0) {
      result.pop_back();
      continue;
    }
    result.back().index = sum;
    sum = 0;
  }
  return result;
}

}  // namespace

FixedPointKind classify(const Eigen::Matrix2d& jacobian, int index, double relativeTolerance) {
  const double det = jacobian.determinant(), trace = jacobian.trace();
  const double rotation = jacobian(1, 0) - jacobian(0, 1);
  // The sign of the determinant is the index of a simple zero.
  if (det * index <= 0.0 || std::abs(index) > 1) return FixedPointKind::Degenerate;
  if (std::abs(det) < relativeTolerance * relativeTolerance * jacobian.squaredNorm()) return FixedPointKind::Degenerate;
  if (det < 0.0) return FixedPointKind::Saddle;
  if (std::abs(trace) < relativeTolerance * std::abs(rotation)) return FixedPointKind::Center;
  return trace > 0.0 ? FixedPointKind::Source : FixedPointKind::Sink;
}

std::vector<FixedPoint> findFixedPoints(const VectorField& field, const FixedPointOptions& options) {
  const std::vector<int> indices = poincareIndices(field);
  std::vector<Index> faces;
  for (Index f = 0; f < field.mesh().faceCount(); ++f) {
    if (indices[f] != 0) faces.push_back(f);
  }
  std::vector<FixedPoint> found(faces.size());
  tbb::parallel_for(std::size_t{0}, faces.size(),
                    [&](std::size_t i) { found[i] = locate(field, faces[i], indices[faces[i]]); });
  found = mergedAtVertices(field, found);
  for (FixedPoint& p : found) {
    p.kind = classify(p.jacobian, p.index, options.relativeTolerance);
    addEigenvectors(*field.charts, p);
    if (p.index < 0) p.separatrices = separatrixDirections(field, p.point);
  }
  return found;
}

}  // namespace stormfield
