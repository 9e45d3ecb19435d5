#include "solver/surface_matrix.h"

#include <algorithm>
#include <utility>

namespace stormfield {

std::vector<Index> inversePermutation(const std::vector<Index>& order) {
  std::vector<Index> inverse(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) inverse[order[i]] = static_cast<Index>(i);
  return inverse;
}

SurfaceMatrix permuted(const SurfaceMatrix& matrix, const std::vector<Index>& order) {
  const std::vector<Index> rank = inversePermutation(order);
  SurfaceMatrix result;
  result.start.reserve(order.size() + 1);
  result.column.reserve(matrix.column.size());
  result.value.reserve(matrix.value.size());
  result.diagonal.reserve(order.size());
  result.mass.reserve(order.size());
  std::vector<std::pair<Index, Complex>> row;
  for (const Index source : order) {
    row.clear();
    for (std::size_t k = matrix.start[source]; k < matrix.start[source + 1]; ++k) {
      row.emplace_back(rank[matrix.column[k]], matrix.value[k]);
    }
    std::sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [column, value] : row) {
      result.column.push_back(column);
      result.value.push_back(value);
    }
    result.start.push_back(result.column.size());
    result.diagonal.push_back(matrix.diagonal[source]);
    result.mass.push_back(matrix.mass[source]);
  }
  return result;
}

}  // namespace stormfield
