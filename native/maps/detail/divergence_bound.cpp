#include "maps/detail/divergence_bound.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "base/message.h"
#include "maps/detail/unfolding.h"
#include "tracing/dense_step.h"

namespace stormfield {
namespace {

/// The bound refuses distances above 2^kDoublings rings of neighbours: an image as wide as 128 faces says nothing. A
/// ring counts as half as wide as the face's longest side, which holds where neighbours are of similar size.
constexpr int kDoublings = 6;

/// Margin of 5 % on the error of unit vectors: the lower bound on the speed leaves out the correction for curvature.
constexpr double kUnitErrorMargin = 1.05;

/// Estimate of what the correction for curvature adds to the gradient: its largest vector, over half the face size.
double gradientOfCorrection(const FlatFace& face, const std::array<Complex, 3>& vectors) {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double half = std::atan(static_cast<double>(face.tanHalf(i)));
    const double rotation = std::min(0.5 * std::abs(static_cast<double>(face.doubleTwist(i))) * half, 3.0);
    largest = std::max(largest, 2.0 * magnitude(vectors[i]) * std::sin(0.5 * rotation));
  }
  return 2.0 * largest / faceSize(face);
}

}  // namespace

DivergenceBound::DivergenceBound(const FlatFaces& faces, const VectorField& field, TauUnit unit,
                                 const std::vector<double>& growthRate, const std::vector<double>& slowSpeeds,
                                 const FieldError& error)
    : faces_(&faces), epsilon_(error.epsilon) {
  std::vector<Rates> own(growthRate.size());
  for (Index f = 0; f < faces.mesh().faceCount(); ++f) {
    const FlatFace& face = faces[f];
    std::array<Complex, 3> vectors;
    double weight = error.weights.empty() ? 1.0 : 0.0, slow = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const Index v = face.vertex(i);
      vectors[i] = face.carry(i, field.values[v]);
      if (!error.weights.empty()) weight = std::max(weight, error.weights[v]);
      if (unit == TauUnit::Length) slow = std::min(slow, slowSpeeds[v]);
    }
    const double off = error.epsilon * weight;
    double fastest = 0.0;
    for (const Complex& v : vectors) fastest = std::max(fastest, magnitude(v));
    own[f] = {growthRate[f] + gradientOfCorrection(face, vectors), off, 2.0 * fastest + off};
    if (unit != TauUnit::Length) continue;
    // The error rotates vectors of unit speed by its ratio to the speed, of which this takes a lower bound.
    const Complex mean = (vectors[0] + vectors[1] + vectors[2]) / 3.0;
    double least = magnitude(mean);
    for (const Complex& v : vectors) least = std::min(least, magnitude(mean) - magnitude(v - mean));
    const double speed = std::hypot(std::max(0.0, least - off), std::max(slow, 1e-300));
    own[f] = {growthRate[f] + gradientOfCorrection(face, vectors) / speed, kUnitErrorMargin * off / speed, 2.0};
  }
  rings_.push_back(withNeighbours(own));
  for (int i = 0; i < kDoublings; ++i) {
    rings_.push_back(rings_.back());
    for (int ring = 0; ring < 1 << i; ++ring) rings_.back() = withNeighbours(rings_.back());
  }
}

/// Per face the largest rates of the faces that share a corner with it, and of the face itself.
std::vector<DivergenceBound::Rates> DivergenceBound::withNeighbours(const std::vector<Rates>& rates) const {
  const TriangleMesh& mesh = faces_->mesh();
  const Rates least{-std::numeric_limits<double>::infinity(), 0.0, 0.0};
  const auto take = [](Rates& to, const Rates& from) {
    to = {std::max(to.growth, from.growth), std::max(to.error, from.error), std::max(to.speed, from.speed)};
  };
  std::vector<Rates> atVertices(mesh.vertexCount(), least), result(rates.size(), least);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    for (int i = 0; i < 3; ++i) take(atVertices[mesh.vertex(f, i)], rates[f]);
  }
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    for (int i = 0; i < 3; ++i) take(result[f], atVertices[mesh.vertex(f, i)]);
  }
  return result;
}

double DivergenceBound::after(double distance, Index face, double duration) const {
  const double rings = 2.0 * distance / (*faces_)[face].longestSide();
  if (!(rings < 1 << kDoublings)) {
    throw InputError(message("fields within eps = ", epsilon_, " separate by more than ", 1 << kDoublings,
                             " faces at face ", face, "; choose a smaller eps or a smaller tau"));
  }
  const auto level = static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(rings)));
  const auto [growth, error, speed] = rings_[level][face];
  const double exponent = growth * duration;
  // The integral of exp(growth t) over the duration.
  const double integral = std::abs(exponent) > 1e-8 ? std::expm1(exponent) / growth : duration;
  return std::min(std::exp(exponent) * distance + error * integral, distance + speed * duration);
}

}  // namespace stormfield
