// The Krylov iteration on the finest level, in single precision: conjugate gradients (Hestenes, Stiefel 1952),
// preconditioned by one multigrid cycle per step.
//
// When to stop. The residual's norm is dominated by heavy constraints, and a smooth error hardly shows in it. So the
// error is estimated as well, in the mean square over surface and lambda: with this preconditioner each step removes
// most of the error, and the steps' lengths fall like the errors, so that step * q / (1 - q) is left after a step that
// is q times as long as the one before. It is an estimate and no bound: docs/performance.md compares it to errors.
//
// Conjugate gradients minimise the error in the energy; minimal residuals reduce a smooth error only slowly. The step
// that ends the iteration may have the length that minimises the residual instead: it has the same direction, and saves
// a step where only the residual is still too long.
#pragma once

#include "solver/detail/multigrid.h"
#include "solver/detail/space_time_operator.h"

namespace stormfield {

/// Rows of the finest level: solution and residual, and memory for two more, which krylovSolve allocates where it is
/// missing; others may use it between solves.
struct KrylovVectors {
  FieldBuffer x, r;
  Pages work;

  explicit KrylovVectors(std::size_t floats) : x(floats), r(floats) {}
};

struct KrylovGoal {
  double residual;  ///< length of r, which is carried along
  double error;     ///< estimated, relative to x; infinite: any
  int maxSteps;
};

struct KrylovOutcome {
  int steps = 0;
  double error = 0.0;  ///< estimate after the last step; infinite where there is none
};

/// Adds the solution of A e = r to x until both goals are met, in one step at least. squares: of the length of r, per
/// chunk. r ends as anything.
KrylovOutcome krylovSolve(Multigrid& multigrid, const SpaceTimeOperator& matrix, KrylovVectors& vectors,
                          std::vector<double> squares, const KrylovGoal& goal, Progress& progress);

}  // namespace stormfield
