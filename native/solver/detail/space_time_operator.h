// The operator A of the space-time system on the finest level, in single precision: what the Krylov iteration applies
// and what the residual of a solution is taken with.
//
//     (A x)_ij = (L x)_ij + k_i (2 x_ij - x_i,j-1 - x_i,j+1) + w_ij x_ij
//
// with one neighbour at the ends of lambda, w_ij the soft weights, and rows of zeros at hard constraints.
#pragma once

#include "solver/detail/constraint_rows.h"

namespace stormfield {

class SpaceTimeOperator {
 public:
  /// mass: area of each row's vertex over that of the surface.
  SpaceTimeOperator(const SurfaceLevel& finest, const std::vector<double>& mass, const ConstraintRows& constraints)
      : level_(finest), mass_(mass), constraints_(constraints) {}

  double mass(Index row) const { return mass_[row]; }

  /// Inner products of a step p, its image q = A p and the residual r.
  struct Products {
    double residualStep = 0.0;   ///< r p
    double stepImage = 0.0;      ///< p q
    double residualImage = 0.0;  ///< r q
    double imageImage = 0.0;     ///< q q
    double stepStep = 0.0;       ///< p p, weighted by area
  };
  /// q = A p.
  Products apply(const float* p, float* q, const float* r, const Progress& progress) const;

  /// r = b / scale - A x; hard values must be in their places in x. `before`: the constraints for which r holds the
  /// residual of the same x already; rows that they treat alike are left out. Returns the squared length per chunk.
  std::vector<double> residual(const float* x, double scale, float* r, const ConstraintRows* before,
                               const Progress& progress) const;

 private:
  /// out = row of A x; line: memory for a row and four floats.
  void image(Index row, const float* x, float* line, float* out) const;

  const SurfaceLevel& level_;
  const std::vector<double>& mass_;
  const ConstraintRows& constraints_;
};

}  // namespace stormfield
