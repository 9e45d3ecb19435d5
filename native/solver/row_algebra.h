// Elementary operations on rows of floats whose length is a multiple of 16 bytes; sums keep a fixed order.
#pragma once

#include "solver/line_kernels.h"

namespace stormfield::kernels {

/// Sum of a[k] b[k] over the row: the real inner product of complex rows.
template <typename Real>
inline double dotRow(const Real* a, const Real* b, std::size_t stride) {
  constexpr std::size_t kLanes = 16 / sizeof(Real);
  VectorOf<Real> sums = {};
  for (std::size_t k = 0; k < stride; k += kLanes) sums += load(a + k) * load(b + k);
  double sum = 0.0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) sum += static_cast<double>(sums[lane]);
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
