#include "solver/detail/sweep_order.h"

#include <algorithm>
#include <numeric>

namespace stormfield {
namespace {

/// Appends the rows first..end in pairs without a common edge, each row with the next one that fits; rows without a
/// partner come last. Returns how many are in pairs.
Index appendPairs(const SurfaceMatrix& matrix, Index first, Index end, std::vector<Index>& order) {
  auto coupled = [&](Index i, Index k) {
    const auto last = matrix.column.begin() + static_cast<std::ptrdiff_t>(matrix.start[i + 1]);
    return std::binary_search(matrix.column.begin() + static_cast<std::ptrdiff_t>(matrix.start[i]), last, k);
  };
  std::vector<Index> waiting(end - first);
  std::iota(waiting.begin(), waiting.end(), first);
  std::vector<Index> single;
  Index paired = 0;
  while (!waiting.empty()) {
    const Index row = waiting.front();
    waiting.erase(waiting.begin());
    const auto partner = std::find_if(waiting.begin(), waiting.end(), [&](Index k) { return !coupled(row, k); });
    if (partner == waiting.end()) {
      single.push_back(row);
      continue;
    }
    order.push_back(row);
    order.push_back(*partner);
    waiting.erase(partner);
    paired += 2;
  }
  order.insert(order.end(), single.begin(), single.end());
  return paired;
}

}  // namespace

SweepOrder sweepOrder(const SurfaceMatrix& matrix, Index rowsPerChunk) {
  const Index rows = matrix.rows();
  const Index chunks = (rows + rowsPerChunk - 1) / rowsPerChunk;
  std::vector<Index> colour(chunks, kNone);
  std::vector<Index> takenBy;  // colour -> last chunk that has it as a neighbour
  for (Index c = 0; c < chunks; ++c) {
    const Index end = std::min(rows, (c + 1) * rowsPerChunk);
    for (std::size_t k = matrix.start[c * rowsPerChunk]; k < matrix.start[end]; ++k) {
      const Index other = matrix.column[k] / rowsPerChunk;
      if (other != c && colour[other] != kNone) takenBy[colour[other]] = c;
    }
    colour[c] = static_cast<Index>(std::find_if(takenBy.begin(), takenBy.end(), [&](Index t) { return t != c; }) -
                                   takenBy.begin());
    if (colour[c] == static_cast<Index>(takenBy.size())) takenBy.push_back(kNone);
  }

  SweepOrder result;
  result.order.reserve(rows);
  result.chunkStart.push_back(0);
  result.colourStart.push_back(0);
  for (Index k = 0; k < static_cast<Index>(takenBy.size()); ++k) {
    for (Index c = 0; c < chunks; ++c) {
      if (colour[c] != k) continue;
      const Index start = static_cast<Index>(result.order.size());
      const Index end = std::min(rows, (c + 1) * rowsPerChunk);
      result.pairEnd.push_back(start + appendPairs(matrix, c * rowsPerChunk, end, result.order));
      result.chunkStart.push_back(static_cast<Index>(result.order.size()));
    }
    result.colourStart.push_back(static_cast<Index>(result.chunkStart.size()) - 1);
  }
  return result;
}

}  // namespace stormfield
