#include "design/design_solve.h"

#include <algorithm>

#include "base/error.h"
#include "design/brush.h"
#include "design/detail/region.h"
#include "design/even_speed.h"

namespace stormfield {

namespace {

SpaceTimeOptions solverOptions(const DesignOptions& options) {
  SpaceTimeOptions result;
  result.samples = options.samples;
  result.lambdaWeight = options.lambdaWeight;
  result.tolerance = options.tolerance;
  return result;
}

const DesignOptions& checked(const DesignOptions& options) {
  if (!(options.evenSpeed >= 0.0 && options.evenSpeed <= 1.0))
    throw InputError("even speed is " + shortNumber(options.evenSpeed) + ": give a number from 0 to 1");
  if (!(options.lambdaPerSecond > 0.0))
    throw InputError("lambda per second is " + shortNumber(options.lambdaPerSecond) + ": give a number above 0");
  return options;
}

/// The speed falls over the core of the smallest singular element; where there is none, over a fraction of its size.
double evenSpeedReach(const std::vector<DesignElement>& elements, double size) {
  constexpr double kFractionOfSize = 0.05;
  double reach = kFractionOfSize * size;
  for (const DesignElement& element : elements)
    if (element.type == ElementType::Singular) reach = std::min(reach, kCore * element.radius.least());
  return reach;
}

}  // namespace

DesignSolver::DesignSolver(std::shared_ptr<const VertexCharts> charts, const DesignOptions& options,
                           const Progress& progress)
    : charts_(std::move(charts)), options_(checked(options)), solver_(charts_, solverOptions(options), progress) {}

void DesignSolver::setOptions(const DesignOptions& options, const Progress& progress) {
  if (solverOptions(checked(options)) != solver_.options()) {
    solver_ = SpaceTimeSolver(charts_, solverOptions(options), progress);
    states_.clear();
  }
  options_ = options;
}

SpaceTimeResult DesignSolver::solve(const std::vector<DesignElement>& elements, Progress& progress, int field,
                                    int fields) {
  constexpr double kConstraintsShare = 0.3;
  const double begin = static_cast<double>(field) / fields, end = static_cast<double>(field + 1) / fields;
  progress.range(begin, begin + kConstraintsShare * (end - begin));
  ElementOptions elementOptions;
  elementOptions.samples = options_.samples;
  elementOptions.lambdaPerSecond = options_.lambdaPerSecond;
  if (static_cast<int>(maps_.size()) <= field) maps_.resize(field + 1);
  ConstraintSet constraints = elementConstraints(charts_, elements, elementOptions, &progress, &maps_[field]);
  progress.range(begin + kConstraintsShare * (end - begin), end);
  if (static_cast<int>(states_.size()) <= field) states_.resize(field + 1);
  SpaceTimeResult result = solver_.solve(constraints, progress, states_[field]);
  const BorderFlow border(*charts_, options_.border);
  if (border.acts()) {
    border.addTo(constraints, result.field);
    result = solver_.solve(constraints, progress, states_[field]);
    border.settle(result.field);
  }
  if (options_.evenSpeed > 0.0)
    result.field = evenSpeed(result.field, options_.evenSpeed, evenSpeedReach(elements, charts_->mesh().size()));
  applyBrushes(result.field, elements, &progress);
  return result;
}

}  // namespace stormfield
