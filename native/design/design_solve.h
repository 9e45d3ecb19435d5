// From a design to its field: constraints, space-time solve, even speed.
//
//   DesignSolver solver(charts, {.samples = 100});
//   SpaceTimeResult result = solver.solve(elements, progress);
#pragma once

#include "design/element_constraints.h"
#include "solver/space_time_solver.h"

namespace stormfield {

struct DesignOptions {
  Index samples = 100;
  double lambdaWeight = 10.0;    ///< omega of thesis eq. 11.3
  double tolerance = 1e-4;       ///< relative residual of the solve
  double evenSpeed = 0.0;        ///< 0: speeds as solved, 1: one speed, falling to 0 at fixed points only
  double lambdaPerSecond = 1.0;  ///< s in d lambda = s dt, for pathlines
};

class DesignSolver {
 public:
  /// Builds what the solves on one mesh share. Throws InputError for options out of range.
  DesignSolver(std::shared_ptr<const VertexCharts> charts, const DesignOptions& options,
               const Progress& progress = Progress());

  /// Throws what elementConstraints and SpaceTimeSolver::solve throw. A warm start from another number of samples is
  /// passed over.
  /// `part` of `parts` says which share of the progress this solve is.
  SpaceTimeResult solve(const std::vector<DesignElement>& elements, Progress& progress,
                        const ParameterizedField* warmStart = nullptr, int part = 0, int parts = 1) const;

 private:
  std::shared_ptr<const VertexCharts> charts_;
  DesignOptions options_;
  SpaceTimeSolver solver_;
};

}  // namespace stormfield
