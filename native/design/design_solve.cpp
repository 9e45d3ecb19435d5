#include "design/design_solve.h"

namespace stormfield {

namespace {

SpaceTimeOptions solverOptions(const DesignOptions& options) {
  SpaceTimeOptions result;
  result.samples = options.samples;
  result.lambdaWeight = options.lambdaWeight;
  result.tolerance = options.tolerance;
  return result;
}

}  // namespace

DesignSolver::DesignSolver(std::shared_ptr<const VertexCharts> charts, const DesignOptions& options,
                           const Progress& progress)
    : charts_(std::move(charts)), options_(options), solver_(charts_, solverOptions(options), progress) {}

SpaceTimeResult DesignSolver::solve(const std::vector<DesignElement>& elements, Progress& progress,
                                    const ParameterizedField* warmStart) const {
  ElementOptions elementOptions;
  elementOptions.samples = options_.samples;
  elementOptions.lambdaPerSecond = options_.lambdaPerSecond;
  const ConstraintSet constraints = elementConstraints(charts_, elements, elementOptions, progress);
  if (warmStart && warmStart->sampleCount() != options_.samples) warmStart = nullptr;
  return solver_.solve(constraints, progress, warmStart);
}

}  // namespace stormfield
