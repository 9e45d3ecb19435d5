// The two inner loops of the solver, over rows of complex float values contiguous in lambda: sums of rotated
// neighbour rows, and the exact solve of one vertex's tridiagonal system in lambda.
#pragma once

#include "design/lambda_grid.h"

namespace stormfield::kernels {

/// 16 bytes: four floats (two complex values) or two doubles (one). InMemory is the same anywhere in an array. Vectors
/// are never passed by value.
template <typename Real>
struct Register;
template <>
struct Register<float> {
  using Type = float __attribute__((vector_size(16)));
  using InMemory = float __attribute__((vector_size(16), aligned(4), may_alias));
};
template <>
struct Register<double> {
  using Type = double __attribute__((vector_size(16)));
  using InMemory = double __attribute__((vector_size(16), aligned(8), may_alias));
};
template <typename Real>
using VectorOf = typename Register<Real>::Type;
using Vector = VectorOf<float>;

template <typename Real>
inline const typename Register<Real>::InMemory& load(const Real* p) {
  return *reinterpret_cast<const typename Register<Real>::InMemory*>(p);
}
template <typename Real>
inline void store(Real* p, const VectorOf<Real>& v) {
  *reinterpret_cast<typename Register<Real>::InMemory*>(p) = v;
}

/// One coupling of a row: the neighbour and the matrix entry.
template <typename Real>
struct CouplingOf {
  Index column;
  Real re, im;
};
using Coupling = CouplingOf<float>;

/// Calls finish(offset, sum over the couplings of entry times neighbour row) for Width vectors from offset k. The two
/// parts of each entry are summed apart, so that the inner loop needs no shuffles.
template <int Width, typename Real, typename Finish>
inline void gatherBlock(const CouplingOf<Real>* first, const CouplingOf<Real>* last, const Real* x, std::size_t stride,
                        std::size_t k, const Finish& finish) {
  constexpr std::size_t kLanes = 16 / sizeof(Real);
  VectorOf<Real> real[Width] = {};
  VectorOf<Real> imaginary[Width] = {};
  for (const CouplingOf<Real>* c = first; c != last; ++c) {
    const Real* row = x + static_cast<std::size_t>(c->column) * stride + k;
    for (int w = 0; w < Width; ++w) {
      const VectorOf<Real> v = load(row + kLanes * w);
      real[w] += c->re * v;
      imaginary[w] += c->im * v;
    }
  }
  for (int w = 0; w < Width; ++w) {
    if constexpr (kLanes == 4) {
      const VectorOf<Real> sign = {-1, 1, -1, 1};
      finish(k + kLanes * w, real[w] + sign * __builtin_shufflevector(imaginary[w], imaginary[w], 1, 0, 3, 2));
    } else {
      const VectorOf<Real> sign = {-1, 1};
      finish(k + kLanes * w, real[w] + sign * __builtin_shufflevector(imaginary[w], imaginary[w], 1, 0));
    }
  }
}

/// The same for the whole row; stride is a multiple of 32 bytes.
template <typename Real, typename Finish>
inline void gatherRow(const CouplingOf<Real>* first, const CouplingOf<Real>* last, const Real* x, std::size_t stride,
                      const Finish& finish) {
  constexpr std::size_t kLanes = 16 / sizeof(Real);
  std::size_t k = 0;
  for (; k + 4 * kLanes <= stride; k += 4 * kLanes) gatherBlock<4>(first, last, x, stride, k, finish);
  for (; k < stride; k += 2 * kLanes) gatherBlock<2>(first, last, x, stride, k, finish);
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
