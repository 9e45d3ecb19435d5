#include "design/detail/pathline_targets.h"

#include <algorithm>
#include <cmath>

namespace stormfield {

void PathlineTargets::add(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const {
  const VertexCharts& charts = context_.charts;
  const double half = std::min(0.5 * step, 0.25 * (path_.end() - path_.start()));
  const double middle = std::clamp(lambda, path_.start() + half, path_.end() - half);
  const Vec3 velocity =
      (path_.positionAt(middle + half) - path_.positionAt(middle - half)) * (context_.lambdaPerSecond / (2.0 * half));
  const double radius = radiusAt(element_, lambda);
  const std::shared_ptr<const LogMap> map = recentLogMap(charts, path_.at(lambda), radius, scratch);
  const Complex flat = charts.spaceToFace(map->source.face, velocity);
  const Complex along = std::abs(flat) > 0.0 ? flat * (velocity.norm() / std::abs(flat)) : flat;
  const auto& triangles = charts.mesh().triangles();
  for (const LogMapEntry& entry : map->entries)
    push(targets, entry.vertex, along * entry.frame(), entry.distance, radius,
         (triangles.row(map->source.face).array() == entry.vertex).any());
}

}  // namespace stormfield
