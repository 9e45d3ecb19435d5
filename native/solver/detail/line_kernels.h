// The exact solve of one vertex's tridiagonal system in lambda, and of two at once.
#pragma once

#include <cstring>

#include "solver/detail/gather_kernel.h"

namespace stormfield::kernels {

/// Four floats (two complex values), which every processor has registers for.
using Vector = VectorOf<16, float>;

template <typename Real>
inline VectorOf<16, Real> load(const Real* p) {
  return loadVector<16>(p);
}
template <typename Real>
inline void store(Real* p, const VectorOf<16, Real>& v) {
  storeVector<16>(p, v);
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
  const VectorOf<16, double> pair = {both, 0.0};
  std::memcpy(&v, &pair, sizeof v);
  v = shuffled<0, 0, 1, 1>(v, v);
}

/// The same for two lines at once. y: 4 floats per sample, the values of both lines; inverse: 2 per sample.
inline void solveTwoLines(const float* inverse, float coupling0, float coupling1, Index samples, float* y) {
  const Index middle = samples / 2;
  const Vector coupling = {coupling0, coupling0, coupling1, coupling1};
  Vector above = {}, below = {}, pivot;
  // Keeps pivot * value, which the substitution needs, and passes coupling * pivot * value on.
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
