// Elements along a curve: streamlines, lines of attachment and separation, designed orbits.
//
// With the unit tangent t of the closest point of the curve, carried to the vertex, and the distance d to the left of
// it, V = speed t + c d i t: thesis eq. 5.3 for each piece of the curve, with c = 0 for a streamline, -rate where flow
// nears the curve and +rate where it leaves it.
//
// An orbit's curve is closed. On it the return map has the multiplier exp(c T), T its period, and nothing else in the
// strip returns. The strip is at least so wide that the mesh resolves it.
#pragma once

#include <algorithm>

#include "design/detail/curve_strip.h"
#include "design/detail/element_targets.h"

namespace stormfield {

class StripTargets : public ElementTargets {
 public:
  /// Throws InputError for an orbit as checkLoop does.
  StripTargets(const TargetContext& context, const DesignElement& element, Index index);

  const std::vector<StripEntry>& strip() const { return strip_; }
  /// At its widest, mesh units.
  double halfWidth() const { return narrowed_ * std::max(least_, element_.radius.largest()); }
  double meanEdge() const { return context_.charts.mesh().meanEdgeLength(); }
  /// Makes the strip narrower by that factor.
  void narrow(double factor) { narrowed_ *= factor; }

 protected:
  void add(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const override;

 private:
  double least_ = 0.0;  ///< half width that the mesh resolves; orbits only
  double narrowed_ = 1.0;
  std::vector<StripEntry> strip_;
};

}  // namespace stormfield
