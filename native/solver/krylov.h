// The Krylov iteration on the finest level, in single precision, preconditioned by one multigrid cycle per step.
//
// First minimal-residual steps (GMRES restarted after every step): with a preconditioner this good they shrink the
// residual, which is what the tolerance speaks of, as fast as conjugate gradients and save them the search direction (a
// pass over three vectors per step). Measured with one and the same cycle on a sphere, 20k vertices x 100 samples, two
// storms of weight 4e5: 4 steps to 1e-4 from zero with either; after a small move of one storm 2 steps against 3. A
// step that does not halve the residual hands over to conjugate gradients.
#pragma once

#include "solver/multigrid.h"
#include "solver/space_time_operator.h"

namespace stormfield {

/// Rows of the finest level: solution, residual, and two to work with, which are there during krylovSolve only.
struct KrylovVectors {
  FieldBuffer x, r, z, p;

  explicit KrylovVectors(std::size_t floats) : x(floats), r(floats) {}
};

/// Adds the solution of A e = r to x until r, which is carried along, is as short as the target, or for so many steps.
/// squares: of the length of r, per chunk. Returns the number of steps. r ends as anything.
int krylovSolve(Multigrid& multigrid, const SpaceTimeOperator& matrix, KrylovVectors& vectors,
                std::vector<double> squares, double target, int maxSteps, Progress& progress);

}  // namespace stormfield
