// One symmetric V-cycle of the space-time multigrid for one set of constraints at a time: the preconditioner of the
// solve (Briggs, Henson, McCormick 2000, A Multigrid Tutorial).
//
// Smoother: Gauss-Seidel over the vertices, each vertex's whole line of samples solved exactly, forward before the
// coarse levels (from zero) and backward after them: lines along the strong coupling, as for anisotropic problems
// (Trottenberg, Oosterlee, Schueller 2001, Multigrid, chapter 5). Hard constraints are rows of zeros; on coarser
// levels they, and soft ones, are lumped weights.
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

  /// 1 per chunk of the finest level that the sweeps leave out, because r is small there; empty: none.
  using ChunkMask = std::vector<char>;

  /// z = M r for rows of the finest level; returns the inner product of r and z. In skipped chunks z is what the
  /// coarser levels make of the r of others (the second sweep takes those beside others), and has no part in the
  /// product. M is symmetric without them only.
  double apply(const float* r, float* z, const ChunkMask& skipped, const Progress& progress);

  const SurfaceLevel& finest() const { return hierarchy_.levels.front(); }

 private:
  struct LevelData {
    LevelWeights weights;
    std::vector<float> mass;     ///< of the samples, for every float of a row
    FieldBuffer inverse;         ///< reciprocal pivots, samples per row
    FieldBuffer x, b, residual;  ///< residual: of the rows here, restricted in lambda
  };
  enum class SweepStart { Zero, Values };

  /// Returns the inner product of b and x on the finest level.
  double cycle(std::size_t level, const float* b, float* x, const ChunkMask& skipped, const Progress& progress);
  void relaxForward(std::size_t level, const float* b, float* x, SweepStart start, const ChunkMask& skipped,
                    const Progress& progress);
  /// Returns the inner product of b and x on the finest level, 0 on others.
  double relaxBackward(std::size_t level, const float* b, float* x, const ChunkMask& skipped, const Progress& progress);
  /// b of the next level from the residual after a forward sweep from zero.
  void restrictResidual(std::size_t level, const float* x, const ChunkMask& skipped, const Progress& progress);
  /// x += the next level's x.
  void prolong(std::size_t level, float* x, const Progress& progress) const;

  /// Sets a row to zero at hard constraints.
  void clearHard(std::size_t level, Index row, float* values) const;
  static bool isSkipped(Index chunk, const ChunkMask& skipped) { return !skipped.empty() && skipped[chunk]; }
  /// Whether a chunk of the finest level has neighbours that are not skipped.
  bool besideOthers(Index chunk, const ChunkMask& skipped) const;

  const SurfaceHierarchy& hierarchy_;
  const ConstraintRows* constraints_ = nullptr;
  std::vector<LevelData> data_;
  std::vector<Index> chunkOf_;  ///< of each row of the finest level
};

}  // namespace stormfield
