// The Krylov iteration on the finest level, in single precision: conjugate gradients, preconditioned by one multigrid
// cycle per step, with a last step that serves the residual where it must.
//
// When to stop. A residual alone says little of the field: heavy constraints rule its norm, and an error that is smooth
// hardly shows in it (two storms of weight 4e5 on 20k vertices x 100 samples, relative residual 9e-5: the field of a
// minimal-residual iteration was 3 % off). So the error is estimated, in the mean square over surface and lambda: with
// a preconditioner this good each step takes away most of the error, and the steps' lengths fall like the errors, so
// that step * q / (1 - q) is left after a step that is q times as long as the one before. It is an estimate and no
// bound; measured against converged fields it is 0.7 to 3 times the error.
//
// Why conjugate gradients: they minimise the error in the energy, minimal residuals the residual, and a smooth error
// with it only slowly (one and the same cycle, the same storms, after 3 steps: 0.4 % against 1.1 %). The step that ends
// the iteration may have the length that minimises the residual instead: that has the same direction, and saves a whole
// step where only the residual is still too long.
#pragma once

#include "solver/detail/multigrid.h"
#include "solver/detail/space_time_operator.h"

namespace stormfield {

/// Rows of the finest level: solution and residual, and memory for two more, which krylovSolve asks for where there is
/// too little, and leaves for others.
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
