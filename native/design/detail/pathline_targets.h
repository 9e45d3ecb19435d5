// A pathline prescribes, on a disc around the particle's place P at lambda, the particle's velocity: with
// d lambda = s dt that is s dP/dlambda, whatever the element's strength (thesis 11.1.3.3).
#pragma once

#include "design/detail/element_targets.h"

namespace stormfield {

class PathlineTargets : public ElementTargets {
 public:
  PathlineTargets(const TargetContext& context, const DesignElement& element, Index index)
      : ElementTargets(context, element, index) {}

 protected:
  void add(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const override;
};

}  // namespace stormfield
