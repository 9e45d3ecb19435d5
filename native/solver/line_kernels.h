// The two inner loops of the solver, over rows of complex float values contiguous in lambda: sums of rotated
// neighbour rows, and the exact solve of one vertex's tridiagonal system in lambda.
#pragma once

#include <cstring>

#include "solver/lambda_grid.h"

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

/// Solves T x = y in place, T tridiagonal with the off-diagonals -coupling, by elimination from both ends towards the
/// middle: two independent chains hide each other's latency. inverse: reciprocal pivots, 0 where the value is fixed at
/// 0.
inline void solveLine(const float* inverse, float coupling, Index samples, float* y) {
  const Index middle = samples / 2;
  auto eliminate = [&](Index from, Index to) {
    const float factor = coupling * inverse[from];
    y[2 * to] += factor * y[2 * from];
    y[2 * to + 1] += factor * y[2 * from + 1];
  };
  auto substitute = [&](Index from, Index to) {
    y[2 * to] = inverse[to] * (y[2 * to] + coupling * y[2 * from]);
    y[2 * to + 1] = inverse[to] * (y[2 * to + 1] + coupling * y[2 * from + 1]);
  };
  for (Index j = 0; j < middle; ++j) eliminate(j, j + 1);
  for (Index j = samples - 1; j > middle; --j) eliminate(j, j - 1);
  y[2 * middle] *= inverse[middle];
  y[2 * middle + 1] *= inverse[middle];
  for (Index j = middle - 1; j >= 0; --j) substitute(j + 1, j);
  for (Index j = middle + 1; j < samples; ++j) substitute(j - 1, j);
}

/// {p0, p0, p1, p1}
inline void loadTwice(const float* p, Vector& v) {
  double both;
  std::memcpy(&both, p, sizeof both);
  const VectorOf<double> pair = {both, 0.0};
  std::memcpy(&v, &pair, sizeof v);
  v = __builtin_shufflevector(v, v, 0, 0, 1, 1);
}

/// The same for two lines at once. y: 4 floats per sample, the values of both lines; inverse: 2 per sample.
inline void solveTwoLines(const float* inverse, float coupling0, float coupling1, Index samples, float* y) {
  const Index middle = samples / 2;
  const Vector coupling = {coupling0, coupling0, coupling1, coupling1};
  Vector above = {}, below = {}, pivot;
  // Keeps pivot * value, which the way back needs, and hands coupling * pivot * value on.
  auto eliminate = [&](Index j, Vector& carried) {
    loadTwice(inverse + 2 * j, pivot);
    const Vector value = load(y + 4 * j) + carried;
    carried = coupling * pivot * value;
    store(y + 4 * j, pivot * value);
  };
  Index top = 0, bottom = samples - 1;
  for (; top < middle && bottom > middle; ++top, --bottom) {
    eliminate(top, above);
    eliminate(bottom, below);
  }
  if (top < middle) eliminate(top, above);
  loadTwice(inverse + 2 * middle, pivot);
  Vector up = pivot * (load(y + 4 * middle) + above + below);
  Vector down = up;
  store(y + 4 * middle, up);
  auto substitute = [&](Index j, Vector& carried) {
    loadTwice(inverse + 2 * j, pivot);
    carried = load(y + 4 * j) + coupling * pivot * carried;
    store(y + 4 * j, carried);
  };
  for (top = middle - 1, bottom = middle + 1; top >= 0 && bottom < samples; --top, ++bottom) {
    substitute(top, up);
    substitute(bottom, down);
  }
  if (top >= 0) substitute(top, up);
}

}  // namespace stormfield::kernels
