// The operator A of the space-time system on the finest level, in single precision: what the Krylov iteration applies
// and what the residual of a solution is taken with.
//
//     (A x)_ij = (L x)_ij + k_i (2 x_ij - x_i,j-1 - x_i,j+1) + w_ij x_ij
//
// with one neighbour at the ends of lambda, w_ij the soft weights, and rows of zeros at hard constraints.
#pragma once

#include "solver/constraint_rows.h"

namespace stormfield {

class SpaceTimeOperator {
 public:
  SpaceTimeOperator(const SurfaceLevel& finest, const ConstraintRows& constraints)
      : level_(finest), constraints_(constraints) {}

  struct Products {
    double withImage = 0.0;  ///< inner product of `with` and q
    double image = 0.0;      ///< of q and q
  };
  /// q = A p.
  Products apply(const float* p, float* q, const float* with, const Progress& progress) const;

  /// r = b / scale - A x; hard values must be in their places in x. `before`: the constraints for which r holds the
  /// residual of the same x already; rows that they treat alike are passed over. Returns the squared length per chunk.
  std::vector<double> residual(const float* x, double scale, float* r, const ConstraintRows* before,
                               const Progress& progress) const;

 private:
  void image(Index row, const float* x, float* out) const;

  const SurfaceLevel& level_;
  const ConstraintRows& constraints_;
};

}  // namespace stormfield
