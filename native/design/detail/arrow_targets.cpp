#include "design/detail/arrow_targets.h"

#include <cmath>

#include "base/error.h"

namespace stormfield {

ArrowTargets::ArrowTargets(const TargetContext& context, const DesignElement& element, Index index,
                           LogMapScratch& scratch)
    : ElementTargets(context, element, index) {
  map_ = logMap(context.charts, path_.points().front(), element.radius.largest(), scratch);
  direction_ = context.charts.spaceToFace(map_.source.face, arrowOf(element).normalized());
  constexpr double kAlmostNormal = 0.05;
  if (std::abs(direction_) < kAlmostNormal)
    throw InputError(describe(element) + " points straight off the surface: turn its arrow along the surface");
  direction_ /= std::abs(direction_);
}

void ArrowTargets::add(double lambda, double, LogMapScratch&, std::vector<Target>& targets) const {
  const double speed = speedAt(lambda), radius = radiusAt(element_, lambda), c = signedRateAt(element_, lambda);
  const Complex along = direction_ * std::polar(1.0, angleAt(element_, lambda));
  const auto& triangles = context_.charts.mesh().triangles();
  for (const LogMapEntry& entry : map_.entries) {
    const Complex z = std::polar(entry.distance, entry.angle);
    const double offset = (std::conj(along) * z).imag();
    const Complex value = along * Complex(speed, c * offset) * entry.frame();
    push(targets, entry.vertex, value, entry.distance, radius,
         (triangles.row(map_.source.face).array() == entry.vertex).any());
  }
}

}  // namespace stormfield
