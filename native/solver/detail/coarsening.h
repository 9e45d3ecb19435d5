// One step of coarsening of a surface matrix: a subset of the vertices and the interpolation from it (Ruge,
// Stueben 1987, Algebraic Multigrid: classical coarsening and interpolation, with tangent vectors carried along edges).
//
// Coarse vertices are picked such that every other vertex has a strong neighbour among them. A vector at a fine vertex
// is the mean of the vectors of its coarse neighbours, each carried over: the entries of the interpolation are positive
// weights times unit rotations. The coarse matrix is the Galerkin product P^H A P; coarse masses are the sums of the
// fine ones.
#pragma once

#include "solver/surface_matrix.h"

namespace stormfield {

/// Compressed rows: fine vertices; columns: coarse ones.
struct Interpolation {
  std::vector<std::size_t> start{0};
  std::vector<Index> column;
  std::vector<Complex> value;

  Index rows() const { return static_cast<Index>(start.size()) - 1; }
};

/// Conjugate transpose, with the given number of rows.
Interpolation adjoint(const Interpolation& interpolation, Index rows);
/// Renames rows (row i becomes rowOrder[i] of the input) and columns (column c becomes columnRank[c]).
Interpolation permuted(const Interpolation& interpolation, const std::vector<Index>& rowOrder,
                       const std::vector<Index>& columnRank);

struct Coarsening {
  Interpolation interpolation;
  SurfaceMatrix matrix;
};

/// Coarse vertices keep the order of the fine ones.
Coarsening coarsen(const SurfaceMatrix& fine);

}  // namespace stormfield
