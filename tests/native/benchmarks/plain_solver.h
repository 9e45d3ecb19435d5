// What the space-time solver is measured against: the plain float32 matrix-free stencil (one application is one
// "sweep") and conjugate gradients with Jacobi's preconditioner on top of it. Vertices in the order of the mesh, no
// hierarchy.
#pragma once

#include <cmath>
#include <complex>
#include <numeric>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "solver/connection_laplacian.h"
#include "solver/constraint.h"
#include "solver/space_time_solver.h"

namespace stormfield::plain {

using Single = std::complex<float>;

/// Soft constraints only.
class PlainSolver {
 public:
  PlainSolver(const VertexCharts& charts, const SpaceTimeOptions& options, const ConstraintSet& constraints)
      : samples_(options.samples) {
    const ConnectionLaplacian laplacian = connectionLaplacian(charts);
    const SurfaceMatrix matrix = permuted(laplacian.matrix, inversePermutation(laplacian.vertex));
    const Index n = matrix.rows();
    start_ = matrix.start;
    column_ = matrix.column;
    for (const Complex a : matrix.value)
      value_.emplace_back(static_cast<float>(a.real()), static_cast<float>(a.imag()));
    for (Index v = 0; v < n; ++v) {
      spatial_.push_back(static_cast<float>(matrix.diagonal[v]));
      coupling_.push_back(static_cast<float>(SpaceTimeSolver::lambdaCoupling(options) * matrix.mass[v]));
    }
    weight_.assign(size(), 0.0f);
    right_.assign(size(), Single());
    for (std::size_t k = 0; k < constraints.size(); ++k) {
      const std::size_t at = static_cast<std::size_t>(constraints.vertex[k]) * samples_ + constraints.sample[k];
      const double weight = constraints.weight[k] * matrix.mass[constraints.vertex[k]];
      weight_[at] += static_cast<float>(weight);
      right_[at] += Single(weight * constraints.value[k]);
    }
  }

  std::size_t size() const { return spatial_.size() * static_cast<std::size_t>(samples_); }

  /// y = A x.
  void sweep(const std::vector<Single>& x, std::vector<Single>& y) const {
    forRows([&](std::size_t v) { sweepRow(v, x.data(), y.data()); });
  }
  /// The same compiled for processors with AVX2.
  void wideSweep(const std::vector<Single>& x, std::vector<Single>& y) const {
    forRows([&](std::size_t v) { wideSweepRow(v, x.data(), y.data()); });
  }

  /// Conjugate gradients from zero to the relative residual; returns the number of iterations.
  int solve(double tolerance) const {
    std::vector<Single> x(size()), r = right_, z(size()), p(size()), q(size());
    const double target = tolerance * std::sqrt(dot(r, r));
    double rz = 0.0;
    for (int iteration = 0;; ++iteration) {
      if (std::sqrt(dot(r, r)) <= target || iteration == 10000) return iteration;
      forAll([&](std::size_t k) {
        const std::size_t v = k / samples_;
        const Index j = static_cast<Index>(k % samples_);
        const float ends = j == 0 || j == samples_ - 1 ? 1.0f : 2.0f;
        z[k] = r[k] / (spatial_[v] + ends * coupling_[v] + weight_[k]);
      });
      const double next = dot(r, z);
      const float beta = iteration == 0 ? 0.0f : static_cast<float>(next / rz);
      rz = next;
      forAll([&](std::size_t k) { p[k] = z[k] + beta * p[k]; });
      sweep(p, q);
      const float alpha = static_cast<float>(rz / dot(p, q));
      forAll([&](std::size_t k) {
        x[k] += alpha * p[k];
        r[k] -= alpha * q[k];
      });
    }
  }

 private:
  [[gnu::always_inline]] void sweepRow(std::size_t v, const Single* x, Single* y) const {
    const Single* own = x + v * samples_;
    Single* out = y + v * samples_;
    const float* weight = weight_.data() + v * samples_;
    const float k = coupling_[v];
    const float diagonal = spatial_[v] + 2.0f * k;
    for (Index j = 0; j < samples_; ++j) out[j] = (diagonal + weight[j]) * own[j];
    for (Index j = 1; j < samples_; ++j) out[j] -= k * own[j - 1];
    for (Index j = 0; j + 1 < samples_; ++j) out[j] -= k * own[j + 1];
    out[0] -= k * own[0];
    out[samples_ - 1] -= k * own[samples_ - 1];
    for (std::size_t e = start_[v]; e < start_[v + 1]; ++e) {
      const Single a = value_[e];
      const Single* other = x + static_cast<std::size_t>(column_[e]) * samples_;
      for (Index j = 0; j < samples_; ++j) out[j] += a * other[j];
    }
  }
  [[gnu::target_clones("avx2", "default")]] void wideSweepRow(std::size_t v, const Single* x, Single* y) const {
    sweepRow(v, x, y);
  }

  template <typename Body>
  void forRows(const Body& body) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, spatial_.size(), 64), [&](const auto& range) {
      for (std::size_t v = range.begin(); v != range.end(); ++v) body(v);
    });
  }
  template <typename Body>
  void forAll(const Body& body) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size(), 1 << 14), [&](const auto& range) {
      for (std::size_t k = range.begin(); k != range.end(); ++k) body(k);
    });
  }
  double dot(const std::vector<Single>& a, const std::vector<Single>& b) const {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, size(), 1 << 14), 0.0,
        [&](const auto& range, double sum) {
          for (std::size_t k = range.begin(); k != range.end(); ++k) {
            sum += static_cast<double>(a[k].real() * b[k].real() + a[k].imag() * b[k].imag());
          }
          return sum;
        },
        std::plus<>());
  }

  Index samples_;
  std::vector<std::size_t> start_;
  std::vector<Index> column_;
  std::vector<Single> value_, right_;
  std::vector<float> spatial_, coupling_, weight_;
};

}  // namespace stormfield::plain
