// From a design to its field: constraints, space-time solve, border, even speed, brush strokes.
//
//   DesignSolver solver(charts, {.samples = 100});
//   SpaceTimeResult result = solver.solve(elements, progress);
//   SpaceTimeResult again = solver.solve(movedElements, progress);  // starts from the last one
#pragma once

#include "design/border.h"
#include "design/element_constraints.h"
#include "solver/space_time_solver.h"

namespace stormfield {

struct DesignOptions {
  Index samples = SpaceTimeOptions().samples;
  double lambdaWeight = SpaceTimeOptions().lambdaWeight;
  double tolerance =
      SpaceTimeOptions().tolerance;  ///< relative residual of the solve; its accuracy is that of SpaceTimeOptions
  double evenSpeed = 0.0;            ///< 0: speeds as solved, 1: one speed, falling to 0 at fixed points only
  double lambdaPerSecond = ElementOptions().lambdaPerSecond;  ///< s in d lambda = s dt, for pathlines
  Border border = Border::Open;
};

/// Keeps what solves on one mesh share, and what each leaves for the next: some five vectors of single precision
/// unknowns per field, and log maps, two and a half at most. A solver that is new starts from zero, and its results
/// depend on nothing but their arguments; after that, fields are the same to the tolerance, but not to the bit.
class DesignSolver {
 public:
  /// Throws InputError for options out of range.
  DesignSolver(std::shared_ptr<const VertexCharts> charts, const DesignOptions& options,
               const Progress& progress = Progress());

  /// For the solves to come; keeps what the change lets it keep. Throws InputError for options out of range.
  void setOptions(const DesignOptions& options, const Progress& progress = Progress());

  /// Throws what elementConstraints and SpaceTimeSolver::solve throw, and is as good as before then. field of fields:
  /// which of several designs on the mesh this is (each starts from its own last solution), and its share of the
  /// progress.
  SpaceTimeResult solve(const std::vector<DesignElement>& elements, Progress& progress, int field = 0, int fields = 1);

 private:
  std::shared_ptr<const VertexCharts> charts_;
  DesignOptions options_;
  SpaceTimeSolver solver_;
  std::vector<SpaceTimeState> states_;  ///< per field
  std::vector<LogMapCache> maps_;       ///< per field
};

}  // namespace stormfield
