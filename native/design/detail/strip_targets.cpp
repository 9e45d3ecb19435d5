#include "design/detail/strip_targets.h"

#include <limits>
#include <map>

#include "base/error.h"
#include "design/detail/loop_checks.h"

namespace stormfield {

namespace {

/// Half widths of orbits, in mean edge lengths: that the mesh resolves, and below which two cannot be kept apart.
constexpr double kResolvedEdges = 2.0, kLeastEdges = 0.75;

/// Distance over the surface between the curves of two strips; infinite where the strips do not overlap.
double distanceBetween(const StripTargets& a, const StripTargets& b) {
  std::map<Index, double> distances;
  for (const StripEntry& entry : a.strip()) distances[entry.vertex] = entry.distance;
  double least = std::numeric_limits<double>::infinity();
  for (const StripEntry& entry : b.strip()) {
    const auto found = distances.find(entry.vertex);
    if (found == distances.end()) continue;
    // Between the two curves distances add up; outside of both the smaller one counts on the other side.
    least = std::min(least, found->second + entry.distance);
  }
  return least;
}

bool shareLambda(const DesignElement& a, const DesignElement& b) {
  return std::max(a.lambdas.front(), b.lambdas.front()) < std::min(a.lambdas.back(), b.lambdas.back());
}

}  // namespace

StripTargets::StripTargets(const TargetContext& context, const DesignElement& element, Index index)
    : ElementTargets(context, element, index) {
  const TriangleMesh& mesh = context.charts.mesh();
  if (element.type == ElementType::Orbit) {
    checkLoop(mesh, path_, element);
    least_ = kResolvedEdges * mesh.meanEdgeLength();
  }
  strip_ = curveStrip(context.charts, path_, halfWidth());
}

void StripTargets::add(double lambda, double, LogMapScratch&, std::vector<Target>& targets) const {
  const double width = narrowed_ * std::max(least_, radiusAt(element_, lambda));
  const double speed = element_.reverse ? -speedAt(lambda) : speedAt(lambda);
  const double c = signedRateAt(element_, lambda);
  for (const StripEntry& entry : strip_)
    push(targets, entry.vertex, entry.direction * Complex(speed, c * entry.offset), entry.distance, width,
         entry.onCurve);
}

void keepOrbitsApart(const std::vector<std::unique_ptr<ElementTargets>>& targets) {
  std::vector<StripTargets*> orbits;
  for (const auto& each : targets)
    if (each->element().type == ElementType::Orbit) orbits.push_back(static_cast<StripTargets*>(each.get()));
  std::vector<double> factor(orbits.size(), 1.0);
  for (std::size_t i = 0; i < orbits.size(); ++i)
    for (std::size_t j = i + 1; j < orbits.size(); ++j) {
      const StripTargets &a = *orbits[i], &b = *orbits[j];
      if (!shareLambda(a.element(), b.element())) continue;
      const double touch = distanceBetween(a, b) / (a.halfWidth() + b.halfWidth());
      if (touch * std::min(a.halfWidth(), b.halfWidth()) < kLeastEdges * a.meanEdge())
        throw InputError(describe(a.element()) + " and " + describe(b.element()) +
                         " come closer to each other than the mesh resolves: move one away, or refine the mesh");
      factor[i] = std::min(factor[i], touch);
      factor[j] = std::min(factor[j], touch);
    }
  for (std::size_t i = 0; i < orbits.size(); ++i) orbits[i]->narrow(std::min(1.0, factor[i]));
}

}  // namespace stormfield
