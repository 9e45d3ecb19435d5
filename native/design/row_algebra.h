// Elementary operations on rows of floats whose length is a multiple of 8; sums keep a fixed order.
#pragma once

#include "design/line_kernels.h"

namespace stormfield::kernels {

inline double sumLanes(const Vector& v) {
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) sum += static_cast<double>(v[k]);
  return sum;
}

/// Sum of a[k] b[k] over the row: the real inner product of complex rows.
inline double dotRow(const float* a, const float* b, std::size_t stride) {
  Vector sum = {};
  for (std::size_t k = 0; k < stride; k += 4) sum += load(a + k) * load(b + k);
  return sumLanes(sum);
}

/// y += factor x.
inline void addRow(float factor, const float* x, float* y, std::size_t stride) {
  for (std::size_t k = 0; k < stride; k += 4) store(y + k, load(y + k) + factor * load(x + k));
}

}  // namespace stormfield::kernels
