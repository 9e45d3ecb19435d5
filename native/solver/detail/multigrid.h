// One symmetric V-cycle of the space-time multigrid for one set of constraints at a time: the preconditioner of the
// solve.
//
// Smoother: Gauss-Seidel over the vertices, each vertex's whole line of samples solved exactly, forward on the way down
// (from zero) and backward on the way up. Hard constraints are rows of zeros; on coarser levels they, and soft ones,
// are lumped weights.
#pragma once

#include "base/progress.h"
#include "solver/detail/level_weights.h"

namespace stormfield {

class Multigrid {
 public:
  explicit Multigrid(const SurfaceHierarchy& hierarchy);

  /// The constraints of the cycles to come, which must outlive them. Lines whose weights stay as they were are not
  /// factorised again.
  void constrain(const ConstraintRows& constraints, const Progress& progress);

  /// z = M r for rows of the finest level; returns the inner product of r and z. silent: chunks of it where r is small
  /// enough for the sweeps to pass them over (none when empty; the second sweep takes those beside others): z is there
  /// what the coarser levels make of the others' r, and has no part in the product. M is symmetric without them only.
  double apply(const float* r, float* z, const std::vector<char>& silent, const Progress& progress);

  const SurfaceLevel& finest() const { return hierarchy_.levels.front(); }

 private:
  struct LevelData {
    LevelWeights weights;
    FieldBuffer inverse;         ///< reciprocal pivots, samples per row
    FieldBuffer x, b, residual;  ///< residual: of the rows here, restricted in lambda
  };

  /// Returns the inner product of b and x on the finest level.
  double cycle(std::size_t level, const float* b, float* x, const std::vector<char>& silent, const Progress& progress);
  /// Whether a silent chunk of the finest level has neighbours that are not.
  bool touched(Index chunk, const std::vector<char>& silent) const;

  const SurfaceHierarchy& hierarchy_;
  const ConstraintRows* constraints_ = nullptr;
  std::vector<LevelData> data_;
  std::vector<Index> chunkOf_;  ///< of each row of the finest level
};

}  // namespace stormfield
