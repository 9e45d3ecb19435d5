// A regular, attachment or separation element at one place: a direction, and how flow nears or leaves its line.
//
// Thesis eq. 5.2, 5.3, in the logarithmic map z of the place: V(z) = speed u + c Im(conj(u) z) i u, where u is the
// direction and c the rate, < 0 for attachment, > 0 for separation and 0 for a regular element; carried along geodesics.
#pragma once

#include "design/detail/element_targets.h"

namespace stormfield {

class ArrowTargets : public ElementTargets {
 public:
  ArrowTargets(const TargetContext& context, const DesignElement& element, Index index, LogMapScratch& scratch);

 protected:
  void add(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const override;

 private:
  Complex direction_;  ///< of the arrow at angle 0, unit, in the flat frame of its face
  LogMap map_;
};

}  // namespace stormfield
