#include "maps/prepared_flow.h"

#include <cmath>

#include "base/error.h"
#include "base/message.h"
#include "maps/detail/divergence_bound.h"
#include "maps/detail/error_checks.h"
#include "maps/detail/flow_advector.h"
#include "maps/detail/unit_speed_flow.h"
#include "maps/fixed_point_faces.h"

namespace stormfield {
namespace {

/// Radians by which the field turns in one step of an image, by its mean gradient: below one radian, a step bends a
/// curve by less than its length.
constexpr double kRotationOfStep = 0.8;

double rateOf(Direction direction) {
  return direction == Direction::Backward ? -1.0 : 1.0;
}

/// Whether flow crosses a boundary halfedge outwards. The component across is linear, so that its ends and middle tell.
bool crossedOutwards(const FlatFaces& faces, const VectorField& field, Index h) {
  const FlatFace& face = faces[TriangleMesh::face(h)];
  const int i = TriangleMesh::corner(h);
  const auto value = [&](int corner) { return field.values[face.vertex(corner)]; };
  const CarriedVectors vectors = face.carry(value(0), value(1), value(2));
  const Complex side = face.corner((i + 1) % 3) - face.corner(i);
  for (const double s : {1e-6, 0.5, 1.0 - 1e-6}) {
    const Complex v = face.evaluate(vectors, face.corner(i) + s * side);
    if ((std::conj(side) * v).imag() < 0.0) return true;
  }
  return false;
}

}  // namespace

PreparedFlow::PreparedFlow(const FlatFaces& faces, const VectorField& field, TauUnit unit, double tolerance,
                           const FieldError& error)
    : faces_(&faces), field_(&field), unit_(unit), tolerance_(tolerance), flowsOut_(mesh().halfedgeCount(), 0) {
  if (field.values.size() != static_cast<std::size_t>(mesh().vertexCount())) {
    throw InputError("the field of the tau map belongs to another mesh");
  }
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    if (std::isfinite(field.values[v].real()) && std::isfinite(field.values[v].imag())) continue;
    throw InputError(message("the vector at vertex ", v, " is not finite; give it a value"));
  }
  TraceOptions options;
  options.tolerance = tolerance;
  checkOptions(options);
  if (unit == TauUnit::Length) {
    slowSpeeds_ = slowSpeeds(field);
  } else {
    along_ = prepareFaces(faces, SteadyFlow(field.values.data(), rateOf(Direction::Forward)));
    against_ = prepareFaces(faces, SteadyFlow(field.values.data(), rateOf(Direction::Backward)));
  }
  holdsFixedPoint_ = fixedPointFaces(field);
  measureFaces();
  checkFieldError(mesh(), error);
  if (error.epsilon > 0.0) {
    divergenceBound_ = std::make_shared<const DivergenceBound>(faces, field, unit, growthRate_, slowSpeeds_, error);
  }
  for (Index h = 0; h < mesh().halfedgeCount(); ++h) {
    flowsOut_[h] = mesh().twin(h) == kNone && crossedOutwards(faces, field, h);
  }
}

/// Rates of the linear part of the field. At unit speed the gradient is that of the direction: the field's over its
/// speed. The rates then count no contraction, so that they are upper bounds.
void PreparedFlow::measureFaces() {
  growthRate_.resize(mesh().faceCount());
  divergenceRate_.resize(mesh().faceCount());
  gradientNorm_.resize(mesh().faceCount());
  double sum = 0.0;
  for (Index f = 0; f < mesh().faceCount(); ++f) {
    const FlatFace& face = (*faces_)[f];
    Complex alongX = 0.0, alongY = 0.0;
    double squaredSpeed = 0.0;
    for (int i = 0; i < 3; ++i) {
      const Complex v = face.carry(i, field_->values[face.vertex(i)]), gradient = face.gradient(i);
      alongX += gradient.real() * v;
      alongY += gradient.imag() * v;
      squaredSpeed += std::norm(v) / 3.0;
      if (unit_ == TauUnit::Length) squaredSpeed += slowSpeeds_[face.vertex(i)] * slowSpeeds_[face.vertex(i)] / 3.0;
    }
    const double divergence = alongX.real() + alongY.imag();
    const double stretch = std::hypot(alongX.real() - alongY.imag(), alongX.imag() + alongY.real());
    gradientNorm_[f] = std::sqrt(std::norm(alongX) + std::norm(alongY));
    growthRate_[f] = 0.5 * (divergence + stretch);
    divergenceRate_[f] = divergence;
    if (unit_ == TauUnit::Length) {
      gradientNorm_[f] /= std::sqrt(std::max(squaredSpeed, 1e-300));
      growthRate_[f] = 0.5 * gradientNorm_[f];
      divergenceRate_[f] = gradientNorm_[f];
    }
    sum += mesh().faceArea(f) * gradientNorm_[f];
  }
  stepTau_ = kRotationOfStep * mesh().totalArea() / sum;
}

int PreparedFlow::stepCount(double tau) const {
  constexpr int kMaxSteps = 128;
  // Doubling leaves a step between 0.75 and 1.5 of stepTau_.
  constexpr double kMaxStep = 1.5;
  int steps = 1;
  while (steps < kMaxSteps && tau / steps > kMaxStep * stepTau_) steps *= 2;
  return steps;
}

std::unique_ptr<PointAdvector> PreparedFlow::advector(Direction direction, const Progress* progress) const {
  const double rate = rateOf(direction);
  const DivergenceBound* const bound = direction == Direction::Forward ? divergenceBound_.get() : nullptr;
  TraceOptions options;
  options.direction = direction;
  options.tolerance = tolerance_;
  if (unit_ == TauUnit::Time) {
    const auto& prepared = direction == Direction::Backward ? against_ : along_;
    return std::make_unique<FlowAdvector<SteadyFlow>>(*faces_, SteadyFlow(field_->values.data(), rate, prepared.get()),
                                                      options, bound, progress);
  }
  return std::make_unique<FlowAdvector<UnitSpeedFlow>>(
      *faces_, UnitSpeedFlow(field_->values.data(), slowSpeeds_.data(), rate), options, bound, progress);
}

}  // namespace stormfield
