// Sums over the neighbour rows of a row, with what the sweeps make of them.
//
// Compiled for the processors everyone has and for those with AVX2, and chosen when first asked for. Both add in the
// same order and neither contracts products and sums, so they give the same bits. Their gain: docs/performance.md.
#pragma once

#include "solver/detail/gather_kernel.h"

namespace stormfield::kernels {

/// S = sum over the couplings from first to last of entry times row of x; stride floats per row, a multiple of 8.
struct RowSums {
  using Pointer = const Coupling*;
  /// out = S
  void (*sum)(Pointer first, Pointer last, const float* x, std::size_t stride, float* out);
  /// out += S
  void (*add)(Pointer first, Pointer last, const float* x, std::size_t stride, float* out);
  /// out = S + diagonal * own - coupling * (value before + value after), complex values of own; one more must be there
  /// on either side.
  void (*image)(Pointer first, Pointer last, const float* x, std::size_t stride, float diagonal, float coupling,
                const float* own, float* out);
  /// out = b - mass * S, with mass per float; b null: out = -mass * S
  void (*residual)(Pointer first, Pointer last, const float* x, std::size_t stride, const float* mass, const float* b,
                   float* out);
  /// Inner products of the row p, its image q and the residual r: r p, p q, r q, q q, p p.
  void (*products)(const float* p, const float* q, const float* r, std::size_t stride, double* five);
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
  static void image(Pointer first, Pointer last, const float* x, std::size_t stride, float diagonal, float coupling,
                    const float* own, float* out) {
    gatherRow<Bytes>(first, last, x, stride, [=](std::size_t k, const Vector& s) {
      const Vector beside = loadVector<Bytes>(own + k - 2) + loadVector<Bytes>(own + k + 2);
      storeVector<Bytes>(out + k, s + diagonal * loadVector<Bytes>(own + k) - coupling * beside);
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

  static void products(const float* p, const float* q, const float* r, std::size_t stride, double* five) {
    // Eight sums of each, in one register or two, so that the order of adding is the same.
    constexpr int kRegisters = 32 / Bytes;
    Vector sums[5][kRegisters] = {};
    for (std::size_t k = 0; k < stride; k += 8) {
      for (int half = 0; half < kRegisters; ++half) {
        const std::size_t at = k + half * (Bytes / sizeof(float));
        const Vector a = loadVector<Bytes>(p + at), b = loadVector<Bytes>(q + at), c = loadVector<Bytes>(r + at);
        sums[0][half] += c * a;
        sums[1][half] += a * b;
        sums[2][half] += c * b;
        sums[3][half] += b * b;
        sums[4][half] += a * a;
      }
    }
    for (int i = 0; i < 5; ++i) {
      five[i] = 0.0;
      for (int half = 0; half < kRegisters; ++half) {
        for (std::size_t lane = 0; lane < Bytes / sizeof(float); ++lane) {
          five[i] += static_cast<double>(sums[i][half][lane]);
        }
      }
    }
  }

  static constexpr RowSums table() { return {&sum, &add, &image, &residual, &products}; }
};

}  // namespace stormfield::kernels
