#include "design/detail/singular_field.h"

#include <cmath>

namespace stormfield {

double speedProfile(double distance, double core) {
  return distance / std::hypot(distance, core);
}

Complex singularValue(const SingularState& state, const LogMapEntry& entry) {
  const double speed = state.speed * speedProfile(entry.distance, kCore * state.radius);
  if (state.kind == SingularKind::Saddle)
    return speed * entry.arrival * std::polar(1.0, 2.0 * (state.axis - entry.angle));
  return speed * rotation(state.kind) * entry.arrival;
}

double axisAngle(const VertexCharts& charts, const DesignElement& element, Index f, double lambda) {
  constexpr double kAlmostNormal = 0.05;
  const Vec3 given = element.direction.value_or(Vec3::UnitX()).normalized();
  Complex reference = charts.spaceToFace(f, given);
  if (std::abs(reference) < kAlmostNormal) reference = charts.spaceToFace(f, Vec3::UnitY());
  if (std::abs(reference) < kAlmostNormal) reference = charts.spaceToFace(f, Vec3::UnitZ());
  return std::arg(reference) + angleAt(element, lambda);
}

}  // namespace stormfield
