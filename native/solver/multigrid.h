// One symmetric V-cycle of the space-time multigrid for one set of constraints: the preconditioner of the solve.
//
// Smoother: Gauss-Seidel over the vertices, each vertex's whole line of samples solved exactly, forward on the way down
// (from zero) and backward on the way up. Hard constraints are rows of zeros; on coarser levels they, and soft ones,
// are lumped weights.
#pragma once

#include "solver/constraint_rows.h"
#include "solver/field_buffer.h"

namespace stormfield {

class Multigrid {
 public:
  Multigrid(const SurfaceHierarchy& hierarchy, const ConstraintRows& constraints, const Progress& progress);

  /// z = M r for rows of the finest level.
  void apply(const float* r, float* z);
  struct Products {
    double withImage = 0.0;  ///< inner product of `with` and q
    double image = 0.0;      ///< of q and q
  };
  /// q = A p on the finest level, hard rows zero.
  Products applyOperator(const float* p, float* q, const float* with) const;

  const SurfaceLevel& finest() const { return hierarchy_.levels.front(); }
  const Progress& progress() const { return progress_; }

 private:
  struct LevelData {
    FieldBuffer inverse;         ///< reciprocal pivots, samples per row
    FieldBuffer x, b, residual;  ///< residual: of the rows here, restricted in lambda
  };

  void cycle(std::size_t level, const float* b, float* x);

  const SurfaceHierarchy& hierarchy_;
  const ConstraintRows& constraints_;
  const Progress& progress_;
  std::vector<LevelData> data_;
};

}  // namespace stormfield
