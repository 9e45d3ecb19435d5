// A sparse Hermitian matrix over the vertices of a surface, together with their masses: the part of the space-time
// system that does not depend on lambda. Rows are compressed; columns ascend within a row and exclude the diagonal.
#pragma once

#include <cstddef>
#include <vector>

#include "base/types.h"

namespace stormfield {

struct SurfaceMatrix {
  std::vector<std::size_t> start{0};  ///< rows + 1
  std::vector<Index> column;
  std::vector<Complex> value;
  std::vector<double> diagonal;  ///< real: the matrix is Hermitian
  std::vector<double> mass;      ///< vertex area as a fraction of the whole area

  Index rows() const { return static_cast<Index>(diagonal.size()); }
};

/// Row i of the result is row order[i] of the matrix, columns renamed alike.
SurfaceMatrix permuted(const SurfaceMatrix& matrix, const std::vector<Index>& order);
/// The inverse of a permutation.
std::vector<Index> inversePermutation(const std::vector<Index>& order);

}  // namespace stormfield
