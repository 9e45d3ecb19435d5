// Sums over the neighbour rows of a row, with what the sweeps make of them.
//
// Compiled for the processors everyone has and for those with AVX2, and chosen when first asked for. Both add in the
// same order and neither contracts products and sums, so they give the same bits. AVX2 makes a solve a quarter faster.
#pragma once

#include "solver/gather_kernel.h"

namespace stormfield::kernels {

/// S = sum over the couplings from first to last of entry times row of x; stride floats per row, a multiple of 8.
struct RowSums {
  using Pointer = const Coupling*;
  /// out = S
  void (*sum)(Pointer first, Pointer last, const float* x, std::size_t stride, float* out);
  /// out += S
  void (*add)(Pointer first, Pointer last, const float* x, std::size_t stride, float* out);
  /// out = S + diagonal * own
  void (*image)(Pointer first, Pointer last, const float* x, std::size_t stride, float diagonal, const float* own,
                float* out);
  /// out = b - mass * S, with mass per float; b null: out = -mass * S
  void (*residual)(Pointer first, Pointer last, const float* x, std::size_t stride, const float* mass, const float* b,
                   float* out);
};

/// The fastest for this processor.
const RowSums& rowSums();

template <int Bytes>
struct RowSumsOf {
  using Pointer = const Coupling*;
  using Vector = VectorOf<Bytes, float>;

  static void sum(Pointer first, Pointer last, const float* x, std::size_t stride, float* out) {
    gatherRow<Bytes>(first, last, x, stride, [=](std::size_t k, const Vector& s) { storeVector<Bytes>(out + k, s); });
  }
  static void add(Pointer first, Pointer last, const float* x, std::size_t stride, float* out) {
    gatherRow<Bytes>(first, last, x, stride, [=](std::size_t k, const Vector& s) {
      storeVector<Bytes>(out + k, loadVector<Bytes>(out + k) + s);
    });
  }
  static void image(Pointer first, Pointer last, const float* x, std::size_t stride, float diagonal, const float* own,
                    float* out) {
    gatherRow<Bytes>(first, last, x, stride, [=](std::size_t k, const Vector& s) {
      storeVector<Bytes>(out + k, s + diagonal * loadVector<Bytes>(own + k));
    });
  }
  static void residual(Pointer first, Pointer last, const float* x, std::size_t stride, const float* mass,
                       const float* b, float* out) {
    if (b) {
      gatherRow<Bytes>(first, last, x, stride, [=](std::size_t k, const Vector& s) {
        storeVector<Bytes>(out + k, loadVector<Bytes>(b + k) - loadVector<Bytes>(mass + k) * s);
      });
    } else {
      gatherRow<Bytes>(first, last, x, stride, [=](std::size_t k, const Vector& s) {
        storeVector<Bytes>(out + k, -(loadVector<Bytes>(mass + k) * s));
      });
    }
  }

  static constexpr RowSums table() { return {&sum, &add, &image, &residual}; }
};

}  // namespace stormfield::kernels
