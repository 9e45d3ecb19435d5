#include "solver/detail/surface_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace stormfield {
namespace {

/// A chunk of rows with its neighbours stays in the second level cache.
Index rowsPerChunk(const LambdaGrid& lambda) {
  return std::clamp(static_cast<Index>(6400 / lambda.samples()), Index{16}, Index{256});
}

template <typename Matrix>
CouplingRows toSingle(const Matrix& matrix) {
  CouplingRows rows;
  rows.start = matrix.start;
  rows.entries.reserve(matrix.column.size());
  for (std::size_t k = 0; k < matrix.column.size(); ++k) {
    rows.entries.push_back(
        {matrix.column[k], static_cast<float>(matrix.value[k].real()), static_cast<float>(matrix.value[k].imag())});
  }
  return rows;
}

SurfaceLevel makeLevel(const SurfaceMatrix& matrix, SweepOrder sweep, const LambdaGrid& lambda, double lambdaCoupling) {
  SurfaceLevel level;
  level.sweep = std::move(sweep);
  level.lambda = lambda;
  level.couplings = toSingle(matrix);
  level.split.reserve(matrix.rows());
  level.diagonal.reserve(matrix.rows());
  level.lambdaCoupling.reserve(matrix.rows());
  for (Index i = 0; i < matrix.rows(); ++i) {
    const auto first = matrix.column.begin() + matrix.start[i];
    const auto last = matrix.column.begin() + matrix.start[i + 1];
    level.split.push_back(std::upper_bound(first, last, i) - matrix.column.begin());
    level.diagonal.push_back(static_cast<float>(matrix.diagonal[i]));
    level.lambdaCoupling.push_back(static_cast<float>(lambdaCoupling * lambda.coupling * matrix.mass[i]));
  }
  return level;
}

/// Whether lambda couples the vertices' samples strongly enough to leave out every other one.
bool lambdaIsStrong(const SurfaceMatrix& matrix, const LambdaGrid& lambda, double lambdaCoupling) {
  if (lambda.samples() < 4) return false;
  const double surface = std::accumulate(matrix.diagonal.begin(), matrix.diagonal.end(), 0.0) * lambda.mass[1];
  const double along = std::accumulate(matrix.mass.begin(), matrix.mass.end(), 0.0) * lambdaCoupling * lambda.coupling;
  return along >= 0.5 * surface;
}

}  // namespace

SurfaceHierarchy surfaceHierarchy(const SurfaceMatrix& matrix, Index samples, double lambdaCoupling,
                                  const Progress& progress) {
  SurfaceHierarchy hierarchy;
  LambdaGrid lambda = finestLambdaGrid(samples);
  SurfaceMatrix natural = matrix;
  std::optional<Interpolation> interpolation;  // from the current matrix to the level before, rows in its sweep order
  while (true) {
    progress.check();
    SweepOrder sweep = sweepOrder(natural, rowsPerChunk(lambda));
    const std::vector<Index> rank = inversePermutation(sweep.order);
    SurfaceMatrix swept = permuted(natural, sweep.order);
    if (interpolation) {
      std::vector<Index> same(interpolation->rows());
      std::iota(same.begin(), same.end(), Index{0});
      const Interpolation renamed = permuted(*interpolation, same, rank);
      hierarchy.levels.back().prolongation = toSingle(renamed);
      hierarchy.levels.back().restriction = toSingle(adjoint(renamed, natural.rows()));
    }
    hierarchy.levels.push_back(makeLevel(swept, sweep, lambda, lambdaCoupling));
    if (hierarchy.levels.size() == 1) {
      hierarchy.matrix = std::move(swept);
      hierarchy.finest = sweep;
    }
    if (natural.column.empty()) return hierarchy;
    progress.check();
    Coarsening next = coarsen(natural);
    std::vector<Index> sameColumns(next.matrix.rows());
    std::iota(sameColumns.begin(), sameColumns.end(), Index{0});
    interpolation = permuted(next.interpolation, sweep.order, sameColumns);
    if (lambdaIsStrong(natural, lambda, lambdaCoupling)) lambda = coarsened(lambda);
    natural = std::move(next.matrix);
  }
}

}  // namespace stormfield
