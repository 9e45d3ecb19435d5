#include "design/detail/bifurcation_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "design/detail/singular_field.h"

namespace stormfield {

namespace {

/// A above, the angular speed of a Hopf bifurcation over the speed at the rim, and the least radius in mean edges.
constexpr double kHalfDistance = 0.5, kTurning = 1.0, kLeastEdges = 3.0;

/// +1 where the pair, or the orbit, is there after the event, -1 where it is there before.
double sense(BifurcationEvent event) {
  const bool after = event == BifurcationEvent::AppearSink || event == BifurcationEvent::AppearSource ||
                     event == BifurcationEvent::HopfBirth;
  return after ? 1.0 : -1.0;
}

bool isHopf(BifurcationEvent event) {
  return event == BifurcationEvent::HopfBirth || event == BifurcationEvent::HopfDeath;
}

bool isSource(BifurcationEvent event) {
  return event == BifurcationEvent::AppearSource || event == BifurcationEvent::VanishSource;
}

/// When it acts: from the reach before what appears, to the reach after what has vanished, always where a point only
/// changes its kind.
LambdaSpan spanOf(const DesignElement& element) {
  LambdaSpan span;
  const double at = element.lambdas.front();
  span.start = !isHopf(element.event) && sense(element.event) > 0.0 ? std::max(0.0, at - element.reach) : 0.0;
  span.end = !isHopf(element.event) && sense(element.event) < 0.0 ? std::min(1.0, at + element.reach) : 1.0;
  return span;
}

}  // namespace

BifurcationTargets::BifurcationTargets(const TargetContext& context, const DesignElement& element, Index index,
                                       LogMapScratch& scratch)
    : ElementTargets(context, element, index), hopf_(isHopf(element.event)) {
  const TriangleMesh& mesh = context.charts.mesh();
  span_ = spanOf(element);
  const double radius = element.radius.largest(), edge = mesh.meanEdgeLength();
  if (radius < kLeastEdges * edge)
    throw InputError(describe(element) + " has radius " + shortNumber(radius) + ", less than " +
                     shortNumber(kLeastEdges) + " edges of the mesh (" + shortNumber(edge) +
                     "), which cannot hold two points apart: make it larger, or refine the mesh");
  map_ = logMap(context.charts, path_.points().front(), radius, scratch);
  for (const LogMapEntry& entry : map_.entries)
    if (mesh.isBoundaryVertex(entry.vertex))
      throw InputError(describe(element) +
                       " reaches the border of the surface, over which points could come and go: "
                       "move it inside by its radius, or make the radius smaller");
  axis_ = axisAngle(context.charts, element, map_.source.face, element.lambdas.front());
  seen_ = hopf_ ? seenTrace(mesh) : seenSquare(mesh);
}

Complex BifurcationTargets::flat(const LogMapEntry& entry) const {
  return std::polar(entry.distance / element_.radius.largest(), entry.angle - axis_);
}

/// The least value of x^2 as the mesh sees it on the line y = 0: there the pair meets.
double BifurcationTargets::seenSquare(const TriangleMesh& mesh) const {
  double least = std::numeric_limits<double>::infinity();
  for (const LogMapEntry& entry : map_.entries)
    for (Index h = mesh.outgoing(entry.vertex); h != kNone; h = mesh.nextOutgoing(h)) {
      const LogMapEntry* other = map_.find(mesh.head(h));
      if (!other) continue;
      const Complex a = flat(entry), b = flat(*other);
      if (a.imag() == 0.0) least = std::min(least, a.real() * a.real());
      if (!((a.imag() > 0.0) != (b.imag() > 0.0))) continue;
      const double t = a.imag() / (a.imag() - b.imag());
      least = std::min(least, (1.0 - t) * a.real() * a.real() + t * b.real() * b.real());
    }
  return std::isfinite(least) ? least : 0.0;
}

/// Half the trace of |z|^2 z as the mesh sees it in the face of the place.
double BifurcationTargets::seenTrace(const TriangleMesh& mesh) const {
  Eigen::Matrix2d edges, values;
  Complex first, firstValue;
  for (int k = 0; k < 3; ++k) {
    const LogMapEntry* entry = map_.find(mesh.vertex(map_.source.face, k));
    if (!entry) return 0.0;
    const Complex z = flat(*entry), value = std::norm(z) * z;
    if (k == 0) {
      first = z;
      firstValue = value;
    } else {
      edges.col(k - 1) << (z - first).real(), (z - first).imag();
      values.col(k - 1) << (value - firstValue).real(), (value - firstValue).imag();
    }
  }
  return 0.5 * (values * edges.inverse()).trace();
}

/// Speed 1; unfolding: A^2 L with the sense of the event.
Complex BifurcationTargets::valueAt(Complex z, double unfolding) const {
  if (hopf_) {
    const double turning = element_.reverse ? -kTurning : kTurning;
    return z * Complex(unfolding + seen_ - std::norm(z), turning);
  }
  const double bent = z.real() * z.real() - seen_;
  return isSource(element_.event) ? Complex(bent - unfolding, z.imag()) : Complex(unfolding - bent, -z.imag());
}

void BifurcationTargets::add(double lambda, double, LogMapScratch&, std::vector<Target>& targets) const {
  const double past = std::clamp((lambda - element_.lambdas.front()) / element_.reach, -1.0, 1.0);
  const double unfolding = kHalfDistance * kHalfDistance * sense(element_.event) * past;
  const double radius = element_.radius.largest(), speed = speedAt(lambda);
  const auto& triangles = context_.charts.mesh().triangles();
  for (const LogMapEntry& entry : map_.entries) {
    const Complex value = speed * valueAt(flat(entry), unfolding) * std::polar(1.0, axis_) * entry.frame();
    const std::size_t before = targets.size();
    push(targets, entry.vertex, value, entry.distance, radius,
         (triangles.row(map_.source.face).array() == entry.vertex).any());
    if (targets.size() > before) targets.back().cover = falloff(entry.distance / radius);
  }
}

void keepBifurcationsAlone(const TriangleMesh& mesh, const std::vector<std::unique_ptr<ElementTargets>>& targets,
                           const std::vector<DesignElement>& elements, const ClosestPointQuery& query) {
  std::vector<const BifurcationTargets*> found;
  for (const auto& each : targets)
    if (each->element().type == ElementType::Bifurcation)
      found.push_back(static_cast<const BifurcationTargets*>(each.get()));
  const auto refuse = [](const DesignElement& a, const DesignElement& b) {
    throw InputError(describe(a) + " and " + describe(b) +
                     " lie at one place: move one away, or let them act at different lambda");
  };
  for (std::size_t i = 0; i < found.size(); ++i) {
    const BifurcationTargets& a = *found[i];
    for (std::size_t j = i + 1; j < found.size(); ++j) {
      const BifurcationTargets& b = *found[j];
      const bool together = a.span().start < b.span().end && b.span().start < a.span().end;
      const double reach = std::max(a.element().radius.largest(), b.element().radius.largest());
      if (together && std::min(a.map().distance(mesh, b.place()), b.map().distance(mesh, a.place())) < reach)
        refuse(a.element(), b.element());
    }
    for (const DesignElement& other : elements) {
      if (other.type != ElementType::Singular) continue;
      const SurfacePath path(mesh, query, other);
      const double first = std::max(a.span().start, path.start()), last = std::min(a.span().end, path.end());
      constexpr int kPlaces = 32;
      for (int k = 0; k <= kPlaces && first <= last; ++k)
        if (a.map().distance(mesh, path.at(first + (last - first) * k / kPlaces)) < a.element().radius.largest())
          refuse(a.element(), other);
    }
  }
}

}  // namespace stormfield
