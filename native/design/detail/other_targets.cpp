#include "design/detail/other_targets.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace stormfield {

OtherTargets::OtherTargets(const VertexCharts& charts, const ClosestPointQuery& query, const DesignElement& element,
                           Index index, double stiffness, double lambdaPerSecond, LogMapScratch& scratch)
    : charts_(charts),
      element_(element),
      index_(index),
      stiffness_(stiffness),
      lambdaPerSecond_(lambdaPerSecond),
      path_(charts.mesh(), query, element) {
  span_.start = path_.start();
  span_.end = path_.end();
  if (element.type == ElementType::Regular) still_ = logMap(charts, path_.points().front(), element.radius, scratch);
  if (element.type == ElementType::Streamline) strip_ = curveStrip(charts, path_, element.radius);
}

double OtherTargets::density() const {
  return centreDensity(stiffness_, charts_.mesh().size(), element_.radius);
}

void OtherTargets::addDisc(const LogMap& map, Complex velocity, double share, std::vector<Target>& targets) const {
  const auto& triangles = charts_.mesh().triangles();
  for (const LogMapEntry& entry : map.entries) {
    double cover = falloff(entry.distance / element_.radius);
    if ((triangles.row(map.source.face).array() == entry.vertex).any()) cover = std::max(cover, kCornerCover);
    if (cover > 0.0)
      targets.push_back({entry.vertex, velocity * entry.frame(), density() * cover * share, 0.0,
                         entry.distance < kCore * element_.radius || cover == kCornerCover, index_});
  }
}

void OtherTargets::addAt(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const {
  const double share = span_.share(lambda, step);
  if (!(share > 0.0)) return;
  const double speed = element_.strength * charts_.mesh().size();

  if (element_.type == ElementType::Streamline) {
    for (const StripEntry& entry : strip_) {
      double cover = falloff(entry.distance / element_.radius);
      if (entry.onCurve) cover = std::max(cover, kCornerCover);
      if (cover > 0.0)
        targets.push_back({entry.vertex, speed * entry.direction, density() * cover * share, 0.0,
                           entry.distance < kCore * element_.radius || cover == kCornerCover, index_});
    }
    return;
  }
  if (element_.type == ElementType::Regular) {
    const Complex direction = charts_.spaceToFace(still_.source.face, arrowOf(element_).normalized());
    constexpr double kAlmostNormal = 0.05;
    if (std::abs(direction) < kAlmostNormal)
      throw InputError(describe(element_) + " points straight off the surface: turn its arrow along the surface");
    addDisc(still_, speed * direction / std::abs(direction), share, targets);
    return;
  }
  const double half = std::min(0.5 * step, 0.25 * (path_.end() - path_.start()));
  const double middle = std::clamp(lambda, path_.start() + half, path_.end() - half);
  const Vec3 velocity =
      (path_.positionAt(middle + half) - path_.positionAt(middle - half)) * (lambdaPerSecond_ / (2.0 * half));
  const std::shared_ptr<const LogMap> map = recentLogMap(charts_, path_.at(lambda), element_.radius, scratch);
  const Complex along = charts_.spaceToFace(map->source.face, velocity);
  addDisc(*map, std::abs(along) > 0.0 ? along * (velocity.norm() / std::abs(along)) : along, share, targets);
}

}  // namespace stormfield
