#include "design/sweep_order.h"

#include <algorithm>

namespace stormfield {

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
      for (Index i = c * rowsPerChunk; i < std::min(rows, (c + 1) * rowsPerChunk); ++i) result.order.push_back(i);
      result.chunkStart.push_back(static_cast<Index>(result.order.size()));
    }
    result.colourStart.push_back(static_cast<Index>(result.chunkStart.size()) - 1);
  }
  return result;
}

}  // namespace stormfield
