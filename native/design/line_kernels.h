// The two inner loops of the solver, over rows of complex float values contiguous in lambda: sums of rotated
// neighbour rows, and the exact solve of one vertex's tridiagonal system in lambda.
#pragma once

#include "design/lambda_grid.h"

namespace stormfield::kernels {

using Vector = float __attribute__((vector_size(16)));
/// The same anywhere in an array of floats. References only: vectors are never passed by value.
using VectorInMemory = float __attribute__((vector_size(16), aligned(4), may_alias));

inline const VectorInMemory& load(const float* p) { return *reinterpret_cast<const VectorInMemory*>(p); }
inline void store(float* p, const Vector& v) { *reinterpret_cast<VectorInMemory*>(p) = v; }

/// One coupling of a row: the neighbour and the matrix entry.
struct Coupling {
  Index column;
  float re, im;
};

/// out = sum of couplings times neighbour rows, over Width vectors at offset k.
template <int Width, typename Finish>
inline void gatherBlock(const Coupling* first, const Coupling* last, const float* x, std::size_t stride, std::size_t k,
                        const Finish& finish) {
  Vector real[Width] = {};
  Vector imaginary[Width] = {};
  for (const Coupling* c = first; c != last; ++c) {
    const float* row = x + static_cast<std::size_t>(c->column) * stride + k;
    for (int w = 0; w < Width; ++w) {
      const Vector v = load(row + 4 * w);
      real[w] += c->re * v;
      imaginary[w] += c->im * v;
    }
  }
  const Vector sign = {-1.0f, 1.0f, -1.0f, 1.0f};
  for (int w = 0; w < Width; ++w) {
    const Vector turned = __builtin_shufflevector(imaginary[w], imaginary[w], 1, 0, 3, 2);
    finish(k + 4 * w, real[w] + sign * turned);
  }
}

/// Calls finish(offset, sum over the couplings) for each vector of the row.
template <typename Finish>
inline void gatherRow(const Coupling* first, const Coupling* last, const float* x, std::size_t stride,
                      const Finish& finish) {
  std::size_t k = 0;
  for (; k + 16 <= stride; k += 16) gatherBlock<4>(first, last, x, stride, k, finish);
  for (; k < stride; k += 8) gatherBlock<2>(first, last, x, stride, k, finish);
}

/// Solves T x = y in place, T tridiagonal with off-diagonals -coupling * grid coupling, by elimination from both ends
/// towards the middle (two independent chains hide each other's latency). inverse: reciprocal pivots, 0 where the
/// value is fixed at 0.
inline void solveLine(const float* inverse, const float* gridCoupling, float coupling, Index samples, float* y) {
  const Index middle = samples / 2;
  float tr = 0.0f, ti = 0.0f, br = 0.0f, bi = 0.0f;
  Index top = 0;
  Index bottom = samples - 1;
  for (; top < middle && bottom > middle; ++top, --bottom) {
    tr += y[2 * top];
    ti += y[2 * top + 1];
    br += y[2 * bottom];
    bi += y[2 * bottom + 1];
    y[2 * top] = tr;
    y[2 * top + 1] = ti;
    y[2 * bottom] = br;
    y[2 * bottom + 1] = bi;
    const float lt = coupling * gridCoupling[top] * inverse[top];
    const float lb = coupling * gridCoupling[bottom - 1] * inverse[bottom];
    tr *= lt;
    ti *= lt;
    br *= lb;
    bi *= lb;
  }
  // An even number of samples leaves one more above the middle than below.
  if (top < middle) {
    tr += y[2 * top];
    ti += y[2 * top + 1];
    y[2 * top] = tr;
    y[2 * top + 1] = ti;
    const float lt = coupling * gridCoupling[top] * inverse[top];
    tr *= lt;
    ti *= lt;
  }
  float xr = inverse[middle] * (y[2 * middle] + tr + br);
  float xi = inverse[middle] * (y[2 * middle + 1] + ti + bi);
  y[2 * middle] = xr;
  y[2 * middle + 1] = xi;
  float zr = xr, zi = xi;
  Index up = middle - 1;
  Index down = middle + 1;
  for (; up >= 0 && down < samples; --up, ++down) {
    const float lu = coupling * gridCoupling[up] * inverse[up];
    const float ld = coupling * gridCoupling[down - 1] * inverse[down];
    xr = inverse[up] * y[2 * up] + lu * xr;
    xi = inverse[up] * y[2 * up + 1] + lu * xi;
    zr = inverse[down] * y[2 * down] + ld * zr;
    zi = inverse[down] * y[2 * down + 1] + ld * zi;
    y[2 * up] = xr;
    y[2 * up + 1] = xi;
    y[2 * down] = zr;
    y[2 * down + 1] = zi;
  }
  if (up >= 0) {
    const float lu = coupling * gridCoupling[up] * inverse[up];
    y[2 * up] = inverse[up] * y[2 * up] + lu * xr;
    y[2 * up + 1] = inverse[up] * y[2 * up + 1] + lu * xi;
  }
}

}  // namespace stormfield::kernels
