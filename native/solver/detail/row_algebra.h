// Elementary operations on rows of floats whose length is a multiple of 16 bytes; sums keep a fixed order.
#pragma once

#include "solver/detail/line_kernels.h"

namespace stormfield::kernels {

/// Asks for the row that a sweep over all rows comes to after some 50 KB: rows of one chunk are neighbours in memory,
/// and a sweep waits for their first use.
inline void prefetchAhead(const float* rows, Index row, Index end, std::size_t stride, int direction) {
  const Index ahead = row + direction * static_cast<Index>(12800 / stride + 1);
  if (ahead < 0 || ahead >= end) return;
  const float* p = rows + ahead * stride;
  for (std::size_t k = 0; k < stride; k += 16) __builtin_prefetch(p + k);
}

/// Sum of a[k] b[k] over the row: the real inner product of complex rows.
template <typename Real>
inline double dotRow(const Real* a, const Real* b, std::size_t stride) {
  constexpr std::size_t kLanes = 16 / sizeof(Real);
  // Four sums, so that none waits for the one before.
  VectorOf<16, Real> sums[4] = {};
  std::size_t k = 0;
  for (; k + 4 * kLanes <= stride; k += 4 * kLanes) {
    for (std::size_t s = 0; s < 4; ++s) sums[s] += load(a + k + s * kLanes) * load(b + k + s * kLanes);
  }
  for (; k < stride; k += kLanes) sums[0] += load(a + k) * load(b + k);
  const VectorOf<16, Real> all = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  double sum = 0.0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) sum += static_cast<double>(all[lane]);
  return sum;
}

/// y += factor x.
inline void addRow(float factor, const float* x, float* y, std::size_t stride) {
  for (std::size_t k = 0; k < stride; k += 4) store(y + k, load(y + k) + factor * load(x + k));
}

/// y = x + factor y; y may be anything, also not a number, when the factor is 0.
inline void scaleAndAdd(float factor, const float* x, float* y, std::size_t stride) {
  if (factor == 0.0f) {
    for (std::size_t k = 0; k < stride; k += 4) store(y + k, load(x + k));
  } else {
    for (std::size_t k = 0; k < stride; k += 4) store(y + k, load(x + k) + factor * load(y + k));
  }
}

}  // namespace stormfield::kernels
