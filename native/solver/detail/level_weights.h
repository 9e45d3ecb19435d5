// Diagonal weights of the constraints on the levels of the hierarchy, and the pivots of the line solves they lead to.
#pragma once

#include "solver/detail/constraint_rows.h"
#include "solver/detail/field_buffer.h"

namespace stormfield {

/// Sparse rows of weights, infinite where a value is fixed.
struct LevelWeights {
  struct Entry {
    Index sample;
    double weight;

    bool operator==(const Entry&) const = default;
  };
  std::vector<std::size_t> start{0};
  std::vector<Entry> entries;
};

LevelWeights finestWeights(const ConstraintRows& constraints);
/// Lumped: the weights of the fine rows are distributed with the interpolation weights. A fixed value weighs as much as
/// the couplings it cuts.
LevelWeights restricted(const LevelWeights& fine, const SurfaceLevel& from, const LambdaGrid& to);
/// Reciprocal pivots of every row's line (kernels::solveLine, solveTwoLines), zero where the value is fixed. `inverse`
/// holds those of the weights `before` (none: no rows), and rows with the same weights are left out.
void updatePivots(const SurfaceLevel& level, const LevelWeights& weights, const LevelWeights& before, float* inverse);

}  // namespace stormfield
