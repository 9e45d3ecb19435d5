#include "maps/detail/divergence_bound.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/message.h"
#include "maps/detail/unfolding.h"
#include "tracing/dense_step.h"

namespace stormfield {
namespace {

/// Points may part by 2^kDoublings rings of neighbours, each taken for half as wide as the face is long.
constexpr int kDoublings = 6;

/// How much the correction for curvature may add to the gradient, seen at the size of the face.
double twisting(const FlatFace& face, const std::array<Complex, 3>& vectors) {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double half = std::atan(static_cast<double>(face.tanHalf(i)));
    const double turn = std::min(0.5 * std::abs(static_cast<double>(face.doubleTwist(i))) * half, 3.0);
    largest = std::max(largest, 2.0 * magnitude(vectors[i]) * std::sin(0.5 * turn));
  }
  return 2.0 * largest / faceSize(face);
}

}  // namespace

void checkError(const TriangleMesh& mesh, const FieldError& error) {
  if (!(error.epsilon >= 0.0) || !std::isfinite(error.epsilon)) {
    throw InputError(message("the error bound eps is ", error.epsilon, "; give a number >= 0"));
  }
  if (error.epsilon == 0.0) return;
  if (!error.weights.empty() && error.weights.size() != static_cast<std::size_t>(mesh.vertexCount())) {
    throw InputError(message("the error bound has ", error.weights.size(), " weights, but the mesh has ",
                             mesh.vertexCount(), " vertices; give one weight per vertex"));
  }
  for (std::size_t v = 0; v < error.weights.size(); ++v) {
    if (error.weights[v] >= 0.0 && std::isfinite(error.weights[v])) continue;
    throw InputError(
        message("the weight of the error at vertex ", v, " is ", error.weights[v], "; give a number >= 0"));
  }
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    if (mesh.twin(h) != kNone) continue;
    throw InputError(message("an error bound of maps of the flow needs a closed surface, but edge ", mesh.edge(h),
                             " is on a boundary; choose the method 'geometry' or set eps to 0"));
  }
}

DivergenceBound::DivergenceBound(const FlatFaces& faces, const VectorField& field, TauUnit unit,
                                 const std::vector<double>& growth, const std::vector<double>& slowSpeeds,
                                 const FieldError& error)
    : faces_(&faces), epsilon_(error.epsilon) {
  std::vector<Rates> own(growth.size());
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
    own[f] = {growth[f] + twisting(face, vectors), off, 2.0 * fastest + off};
    if (unit != TauUnit::Length) continue;
    // At unit speed vectors turn by the error over the speed, of which a lower bound is taken.
    const Complex mean = (vectors[0] + vectors[1] + vectors[2]) / 3.0;
    double least = magnitude(mean);
    for (const Complex& v : vectors) least = std::min(least, magnitude(mean) - magnitude(v - mean));
    const double speed = std::hypot(std::max(0.0, least - off), std::max(slow, 1e-300));
    own[f] = {growth[f] + twisting(face, vectors) / speed, 1.05 * off / speed, 2.0};
  }
  within_.push_back(around(own));
  for (int i = 0; i < kDoublings; ++i) {
    within_.push_back(within_.back());
    for (int ring = 0; ring < 1 << i; ++ring) within_.back() = around(within_.back());
  }
}

std::vector<DivergenceBound::Rates> DivergenceBound::around(const std::vector<Rates>& rates) const {
  const TriangleMesh& mesh = faces_->mesh();
  const Rates least{-std::numeric_limits<double>::infinity(), 0.0, 0.0};
  const auto take = [](Rates& to, const Rates& from) {
    to = {std::max(to.growth, from.growth), std::max(to.error, from.error), std::max(to.fastest, from.fastest)};
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
    throw InputError(message("fields within eps = ", epsilon_, " part by more than ", 1 << kDoublings,
                             " faces at face ", face, "; choose a smaller eps or a smaller tau"));
  }
  const auto level = static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(rings)));
  const auto [growth, error, fastest] = within_[level][face];
  const double grown = growth * duration;
  const double fed = std::abs(grown) > 1e-8 ? std::expm1(grown) / growth : duration;
  return std::min(std::exp(grown) * distance + error * fed, distance + fastest * duration);
}

}  // namespace stormfield
