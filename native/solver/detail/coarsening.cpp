#include "solver/detail/coarsening.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <tbb/parallel_for.h>

namespace stormfield {
namespace {

/// A neighbour is strong when its weight is at least this fraction of the row's largest.
constexpr double kStrong = 0.4;
/// A fine vertex interpolates from its coarse neighbours alone when they carry this fraction of its strong weight.
constexpr double kEnoughSupport = 0.45;
/// Upper limit on the terms of one interpolated vector.
constexpr std::size_t kMaxTerms = 6;

struct Term {
  Index column;
  Complex value;
};
using Row = std::vector<Term>;

/// Adds terms with the same column and sorts by column.
void gather(Row& row) {
  std::sort(row.begin(), row.end(), [](const Term& a, const Term& b) { return a.column < b.column; });
  std::size_t last = 0;
  for (std::size_t k = 1; k < row.size(); ++k) {
    if (row[k].column == row[last].column) {
      row[last].value += row[k].value;
    } else {
      row[++last] = row[k];
    }
  }
  if (!row.empty()) row.resize(last + 1);
}

/// Rows made in parallel, appended in order.
template <typename MakeRow>
void appendRows(Index rows, std::vector<std::size_t>& start, std::vector<Index>& column, std::vector<Complex>& value,
                const MakeRow& makeRow) {
  constexpr Index kBlock = 1024;
  const Index blocks = (rows + kBlock - 1) / kBlock;
  struct Block {
    std::vector<std::size_t> lengths;
    std::vector<Term> terms;
  };
  std::vector<Block> rowsOfBlock(blocks);
  tbb::parallel_for(Index{0}, blocks, [&](Index b) {
    Row row;
    for (Index i = b * kBlock; i < std::min(rows, (b + 1) * kBlock); ++i) {
      row.clear();
      makeRow(i, row);
      rowsOfBlock[b].lengths.push_back(row.size());
      rowsOfBlock[b].terms.insert(rowsOfBlock[b].terms.end(), row.begin(), row.end());
    }
  });
  std::size_t terms = column.size();
  for (const Block& block : rowsOfBlock) terms += block.terms.size();
  start.reserve(start.size() + rows);
  column.reserve(terms);
  value.reserve(terms);
  for (Block& block : rowsOfBlock) {
    for (const std::size_t length : block.lengths) start.push_back(start.back() + length);
    for (const Term& term : block.terms) {
      column.push_back(term.column);
      value.push_back(term.value);
    }
    block = {};
  }
}

std::vector<double> strengthThresholds(const SurfaceMatrix& matrix) {
  std::vector<double> thresholds(matrix.rows(), 0.0);
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
      thresholds[i] = std::max(thresholds[i], kStrong * std::abs(matrix.value[k]));
    }
  }
  return thresholds;
}

/// 1 at coarse vertices: each next one is the undecided vertex that most others would interpolate from.
std::vector<char> pickCoarse(const SurfaceMatrix& matrix, const std::vector<double>& thresholds) {
  enum : char { kFine = 0, kCoarse = 1, kUndecided = 2 };
  const Index n = matrix.rows();
  std::vector<char> state(n, kUndecided);
  std::vector<Index> priority(n, 0);
  std::vector<std::vector<Index>> buckets;
  auto push = [&](Index i) {
    if (priority[i] >= static_cast<Index>(buckets.size())) buckets.resize(priority[i] + 1);
    buckets[priority[i]].push_back(i);
  };
  auto forStrong = [&](Index i, const auto& visit) {
    for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
      const Index j = matrix.column[k];
      if (std::abs(matrix.value[k]) >= std::min(thresholds[i], thresholds[j])) visit(j);
    }
  };
  for (Index i = n - 1; i >= 0; --i) {
    forStrong(i, [&](Index) { ++priority[i]; });
    push(i);
  }
  while (!buckets.empty()) {
    if (buckets.back().empty()) {
      buckets.pop_back();
      continue;
    }
    const Index i = buckets.back().back();
    buckets.back().pop_back();
    if (state[i] != kUndecided || priority[i] + 1 != static_cast<Index>(buckets.size())) continue;
    state[i] = kCoarse;
    forStrong(i, [&](Index j) {
      if (state[j] != kUndecided) return;
      state[j] = kFine;
      forStrong(j, [&](Index k) {
        if (state[k] != kUndecided) return;
        ++priority[k];
        push(k);
      });
    });
  }
  return state;
}

/// Keeps the largest terms and makes their absolute values add up to one.
void normalise(Row& row) {
  if (row.size() > kMaxTerms) {
    std::stable_sort(row.begin(), row.end(),
                     [](const Term& a, const Term& b) { return std::abs(a.value) > std::abs(b.value); });
    row.resize(kMaxTerms);
    std::sort(row.begin(), row.end(), [](const Term& a, const Term& b) { return a.column < b.column; });
  }
  double sum = 0.0;
  for (const Term& term : row) sum += std::abs(term.value);
  for (Term& term : row) term.value /= sum;
}

Interpolation interpolate(const SurfaceMatrix& matrix, const std::vector<double>& thresholds,
                          const std::vector<char>& coarse, const std::vector<Index>& coarseIndex) {
  auto addCoarseNeighbours = [&](Index i, Complex factor, Row& row) {
    if (coarse[i]) {
      row.push_back({coarseIndex[i], factor});
      return;
    }
    double sum = 0.0;
    const std::size_t first = row.size();
    for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
      const Index j = matrix.column[k];
      const double size = std::abs(matrix.value[k]);
      if (!coarse[j] || size < std::min(thresholds[i], thresholds[j])) continue;
      row.push_back({coarseIndex[j], -matrix.value[k]});
      sum += size;
    }
    for (std::size_t k = first; k < row.size(); ++k) row[k].value *= factor / sum;
  };
  Interpolation result;
  appendRows(matrix.rows(), result.start, result.column, result.value, [&](Index i, Row& row) {
    if (coarse[i]) {
      row.push_back({coarseIndex[i], 1.0});
      return;
    }
    double fromCoarse = 0.0;
    double all = 0.0;
    Index coarseCount = 0;
    for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
      const Index j = matrix.column[k];
      const double size = std::abs(matrix.value[k]);
      if (size < std::min(thresholds[i], thresholds[j])) continue;
      all += size;
      if (!coarse[j]) continue;
      fromCoarse += size;
      ++coarseCount;
    }
    if (coarseCount >= 2 && fromCoarse >= kEnoughSupport * all) {
      addCoarseNeighbours(i, 1.0, row);
    } else {
      for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
        const Index j = matrix.column[k];
        if (std::abs(matrix.value[k]) < std::min(thresholds[i], thresholds[j])) continue;
        addCoarseNeighbours(j, -matrix.value[k], row);
      }
      gather(row);
    }
    normalise(row);
  });
  return result;
}

SurfaceMatrix galerkin(const SurfaceMatrix& fine, const Interpolation& p, Index coarseRows) {
  const Interpolation restriction = adjoint(p, coarseRows);
  SurfaceMatrix coarse;
  coarse.diagonal.assign(coarseRows, 0.0);
  coarse.mass.assign(coarseRows, 0.0);
  appendRows(coarseRows, coarse.start, coarse.column, coarse.value, [&](Index c, Row& row) {
    auto addFine = [&](Index i, Complex factor) {
      for (std::size_t k = p.start[i]; k < p.start[i + 1]; ++k) row.push_back({p.column[k], factor * p.value[k]});
    };
    for (std::size_t k = restriction.start[c]; k < restriction.start[c + 1]; ++k) {
      const Index i = restriction.column[k];
      coarse.mass[c] += std::abs(restriction.value[k]) * fine.mass[i];
      addFine(i, restriction.value[k] * fine.diagonal[i]);
      for (std::size_t e = fine.start[i]; e < fine.start[i + 1]; ++e) {
        addFine(fine.column[e], restriction.value[k] * fine.value[e]);
      }
    }
    gather(row);
    const auto own = std::find_if(row.begin(), row.end(), [&](const Term& t) { return t.column == c; });
    coarse.diagonal[c] = std::max(own->value.real(), 0.0);
    row.erase(own);
  });
  return coarse;
}

}  // namespace

Interpolation adjoint(const Interpolation& interpolation, Index rows) {
  Interpolation result;
  result.start.assign(rows + 1, 0);
  for (const Index c : interpolation.column) ++result.start[c + 1];
  for (Index r = 0; r < rows; ++r) result.start[r + 1] += result.start[r];
  result.column.resize(interpolation.column.size());
  result.value.resize(interpolation.column.size());
  std::vector<std::size_t> next(result.start.begin(), result.start.end() - 1);
  for (Index i = 0; i < interpolation.rows(); ++i) {
    for (std::size_t k = interpolation.start[i]; k < interpolation.start[i + 1]; ++k) {
      const std::size_t at = next[interpolation.column[k]]++;
      result.column[at] = i;
      result.value[at] = std::conj(interpolation.value[k]);
    }
  }
  return result;
}

Interpolation permuted(const Interpolation& interpolation, const std::vector<Index>& rowOrder,
                       const std::vector<Index>& columnRank) {
  Interpolation result;
  result.start.reserve(rowOrder.size() + 1);
  result.column.reserve(interpolation.column.size());
  result.value.reserve(interpolation.value.size());
  for (const Index source : rowOrder) {
    for (std::size_t k = interpolation.start[source]; k < interpolation.start[source + 1]; ++k) {
      result.column.push_back(columnRank[interpolation.column[k]]);
      result.value.push_back(interpolation.value[k]);
    }
    result.start.push_back(result.column.size());
  }
  return result;
}

Coarsening coarsen(const SurfaceMatrix& fine) {
  const std::vector<double> thresholds = strengthThresholds(fine);
  const std::vector<char> coarse = pickCoarse(fine, thresholds);
  std::vector<Index> coarseIndex(fine.rows(), kNone);
  Index coarseRows = 0;
  for (Index i = 0; i < fine.rows(); ++i) {
    if (coarse[i]) coarseIndex[i] = coarseRows++;
  }
  Coarsening result;
  result.interpolation = interpolate(fine, thresholds, coarse, coarseIndex);
  result.matrix = galerkin(fine, result.interpolation, coarseRows);
  return result;
}

}  // namespace stormfield
