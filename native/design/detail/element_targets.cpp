#include "design/detail/element_targets.h"

#include <algorithm>

#include "design/detail/arrow_targets.h"
#include "design/detail/bifurcation_targets.h"
#include "design/detail/pathline_targets.h"
#include "design/detail/strip_targets.h"

namespace stormfield {

ElementTargets::ElementTargets(const TargetContext& context, const DesignElement& element, Index index)
    : context_(context), element_(element), index_(index), path_(context.charts.mesh(), context.query, element) {
  span_.start = element.lambdas.front();
  span_.end = element.lambdas.back();
}

void ElementTargets::addAt(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const {
  const double share = span_.share(lambda, step) * holdAt(element_, lambda);
  if (!(share > 0.0)) return;
  const std::size_t before = targets.size();
  add(lambda, step, scratch, targets);
  for (std::size_t i = before; i < targets.size(); ++i) {
    targets[i].weight *= share;
    targets[i].cover *= share;
  }
}

void ElementTargets::push(std::vector<Target>& targets, Index vertex, Complex value, double distance, double radius,
                          bool always) const {
  double cover = falloff(distance / radius);
  if (always) cover = std::max(cover, kCornerCover);
  if (!(cover > 0.0)) return;
  const double density = centreDensity(context_.stiffness, context_.charts.mesh().size(), radius);
  targets.push_back({vertex, value, density * cover, 0.0, distance < kCore * radius || cover == kCornerCover, index_});
}

std::unique_ptr<ElementTargets> makeTargets(const TargetContext& context, const DesignElement& element, Index index,
                                            LogMapScratch& scratch) {
  switch (element.type) {
    case ElementType::Pathline:
      return std::make_unique<PathlineTargets>(context, element, index);
    case ElementType::Streamline:
    case ElementType::Orbit:
      return std::make_unique<StripTargets>(context, element, index);
    case ElementType::Attachment:
    case ElementType::Separation:
      if (isCurve(element)) return std::make_unique<StripTargets>(context, element, index);
      break;
    case ElementType::Bifurcation:
      return std::make_unique<BifurcationTargets>(context, element, index, scratch);
    case ElementType::Regular:
    case ElementType::Singular:
    case ElementType::Brush:
      break;
  }
  return std::make_unique<ArrowTargets>(context, element, index, scratch);
}

}  // namespace stormfield
