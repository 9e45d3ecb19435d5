// The levels of the space-time multigrid: coarser and coarser surfaces, and coarser lambda where its coupling is
// strong.
//
// Level operator: A = L (x) diag(mass of samples) + diag(vertex coupling) (x) T, with L a surface matrix, T the
// second difference in lambda, plus the weights of the constraints, which a solve brings along. Rows are numbered by
// the level's sweep order. A level keeps every other sample of lambda when lambda couples at least about as
// strongly as the surface: the exact line solves then smooth what the coarser samples cannot represent.
#pragma once

#include "base/progress.h"
#include "solver/detail/coarsening.h"
#include "solver/detail/lambda_grid.h"
#include "solver/detail/line_kernels.h"
#include "solver/detail/sweep_order.h"

namespace stormfield {

/// Compressed rows in single precision.
struct CouplingRows {
  std::vector<std::size_t> start{0};
  std::vector<kernels::Coupling> entries;

  const kernels::Coupling* begin(Index row) const { return entries.data() + start[row]; }
  const kernels::Coupling* end(Index row) const { return entries.data() + start[row + 1]; }
};

struct SurfaceLevel {
  SweepOrder sweep;
  LambdaGrid lambda;
  CouplingRows couplings;             ///< off-diagonal part of L
  std::vector<std::size_t> split;     ///< first coupling of a row to a later row
  std::vector<float> diagonal;        ///< of L
  std::vector<float> lambdaCoupling;  ///< of neighbouring samples, per vertex
  CouplingRows prolongation;          ///< rows here, columns on the next level; empty on the last
  CouplingRows restriction;           ///< its adjoint

  Index rows() const { return static_cast<Index>(diagonal.size()); }
};

struct SurfaceHierarchy {
  std::vector<SurfaceLevel> levels;
  /// The finest matrix in double precision and its sweep order.
  SurfaceMatrix matrix;
  SweepOrder finest;
};

/// lambdaCoupling: coupling of neighbouring samples at a vertex that owns the whole area.
SurfaceHierarchy surfaceHierarchy(const SurfaceMatrix& matrix, Index samples, double lambdaCoupling,
                                  const Progress& progress);

}  // namespace stormfield
