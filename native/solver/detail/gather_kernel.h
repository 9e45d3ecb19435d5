// The inner loop of the solver: sums of rotated neighbour rows, over rows of complex values contiguous in lambda.
// Templates on the width of a vector register alone, so that one of them may be compiled for newer processors
// (row_sums.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "base/types.h"

namespace stormfield::kernels {

/// A vector register of that many bytes. Registers wider than the processor's are never instantiated, because passing
/// them by value would depend on how a file is compiled.
template <int Bytes, typename Real>
struct Register;
template <>
struct Register<16, float> {
  using Type = float __attribute__((vector_size(16)));
};
template <>
struct Register<32, float> {
  using Type = float __attribute__((vector_size(32)));
};
template <>
struct Register<16, double> {
  using Type = double __attribute__((vector_size(16)));
};
template <int Bytes, typename Real>
using VectorOf = typename Register<Bytes, Real>::Type;

/// Copies, because a reference to an under-aligned vector loses its alignment under Clang. One instruction each.
template <int Bytes, typename Real>
inline VectorOf<Bytes, Real> loadVector(const Real* p) {
  VectorOf<Bytes, Real> v;
  __builtin_memcpy(&v, p, Bytes);
  return v;
}
template <int Bytes, typename Real>
inline void storeVector(Real* p, const VectorOf<Bytes, Real>& v) {
  __builtin_memcpy(p, &v, Bytes);
}

/// The chosen lanes of a, whose numbers come first, and b. Inlined always, so that no copy for newer processors is left
/// over for others to call.
template <int... Lanes, typename Vector>
[[gnu::always_inline]] inline Vector shuffled(const Vector& a, const Vector& b) {
#if __has_builtin(__builtin_shufflevector)
  return __builtin_shufflevector(a, b, Lanes...);
#else  // GCC 11
  using Lane = std::conditional_t<sizeof(a[0]) == 4, std::int32_t, std::int64_t>;
  using Mask [[gnu::vector_size(sizeof(Vector))]] = Lane;
  return __builtin_shuffle(a, b, Mask{Lanes...});
#endif
}

/// One coupling of a row: the neighbour and the matrix entry.
template <typename Real>
struct CouplingOf {
  Index column;
  Real re, im;
};
using Coupling = CouplingOf<float>;

/// v += i w for rows of complex values.
template <int Bytes, typename Real>
inline void addTimesI(VectorOf<Bytes, Real>& v, const VectorOf<Bytes, Real>& w) {
  if constexpr (Bytes / sizeof(Real) == 2) {
    v += VectorOf<Bytes, Real>{-1, 1} * shuffled<1, 0>(w, w);
  } else if constexpr (Bytes / sizeof(Real) == 4) {
    v += VectorOf<Bytes, Real>{-1, 1, -1, 1} * shuffled<1, 0, 3, 2>(w, w);
  } else {
    v += VectorOf<Bytes, Real>{-1, 1, -1, 1, -1, 1, -1, 1} * shuffled<1, 0, 3, 2, 5, 4, 7, 6>(w, w);
  }
}

/// Calls finish(offset, sum over the couplings of entry times neighbour row) for Width vectors from offset k. The
/// real and imaginary factors of each entry are summed apart, so that the inner loop needs no shuffles.
template <int Bytes, int Width, typename Real, typename Finish>
inline void gatherBlock(const CouplingOf<Real>* first, const CouplingOf<Real>* last, const Real* x, std::size_t stride,
                        std::size_t k, const Finish& finish) {
  constexpr std::size_t kLanes = Bytes / sizeof(Real);
  VectorOf<Bytes, Real> real[Width] = {};
  VectorOf<Bytes, Real> imaginary[Width] = {};
  for (const CouplingOf<Real>* c = first; c != last; ++c) {
    const Real* row = x + static_cast<std::size_t>(c->column) * stride + k;
    for (int w = 0; w < Width; ++w) {
      const VectorOf<Bytes, Real> v = loadVector<Bytes>(row + kLanes * w);
      real[w] += c->re * v;
      imaginary[w] += c->im * v;
    }
  }
  for (int w = 0; w < Width; ++w) {
    addTimesI<Bytes, Real>(real[w], imaginary[w]);
    finish(k + kLanes * w, real[w]);
  }
}

/// The same for the whole row; stride is a multiple of 32 bytes.
template <int Bytes, typename Real, typename Finish>
inline void gatherRow(const CouplingOf<Real>* first, const CouplingOf<Real>* last, const Real* x, std::size_t stride,
                      const Finish& finish) {
  constexpr std::size_t kLanes = Bytes / sizeof(Real);
  constexpr int kTail = 32 / Bytes;
  std::size_t k = 0;
  for (; k + 4 * kLanes <= stride; k += 4 * kLanes) gatherBlock<Bytes, 4>(first, last, x, stride, k, finish);
  for (; k < stride; k += kTail * kLanes) gatherBlock<Bytes, kTail>(first, last, x, stride, k, finish);
}

}  // namespace stormfield::kernels
