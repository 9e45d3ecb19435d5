#include "solver/krylov.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <tbb/parallel_for.h>

#include "solver/row_algebra.h"

namespace stormfield {
namespace {

/// A minimal-residual step that leaves more than this of the residual was the last of its kind.
constexpr double kSlowStep = 0.5;
/// The length of the next residual follows from inner products when it is no shorter than this part of the last one;
/// below, their rounding shows.
constexpr double kTrustedGain = 0.03;

class Iteration {
 public:
  Iteration(Multigrid& multigrid, float* r, float* x, bool fromZero, double length, double target, int maxSteps,
            Progress& progress)
      : multigrid_(multigrid),
        r_(r),
        x_(x),
        fromZero_(fromZero),
        first_(length),
        length_(length),
        target_(target),
        maxSteps_(maxSteps),
        progress_(progress),
        p_(floats()),
        z_(floats()) {}

  int run() {
    while (!finished() && minimalResidualStep()) {
    }
    conjugateGradients();
    return steps_;
  }

 private:
  std::size_t floats() const {
    const SurfaceLevel& level = multigrid_.finest();
    return static_cast<std::size_t>(level.rows()) * level.lambda.stride();
  }
  bool finished() const { return length_ <= target_ || steps_ >= maxSteps_; }

  /// Calls body(offset, floats) for every chunk and adds up what it returns, in a fixed order.
  template <typename Body>
  double sumOverChunks(const Body& body) const {
    const SurfaceLevel& level = multigrid_.finest();
    const std::size_t stride = level.lambda.stride();
    std::vector<double> parts(level.sweep.chunks(), 0.0);
    tbb::parallel_for(Index{0}, level.sweep.chunks(), [&](Index chunk) {
      progress_.check();
      const std::size_t begin = level.sweep.chunkStart[chunk] * stride;
      parts[chunk] = body(begin, level.sweep.chunkStart[chunk + 1] * stride - begin);
    });
    double sum = 0.0;
    for (const double part : parts) sum += part;
    return sum;
  }

  void count(double length) {
    length_ = length;
    ++steps_;
    progress_.report(std::clamp(std::log(length_ / first_) / std::log(target_ / first_), 0.0, 1.0));
  }
  void advance(float alpha, const float* direction, std::size_t at, std::size_t size) const {
    if (fromZero_ && steps_ == 0) std::fill(x_ + at, x_ + at + size, 0.0f);
    kernels::addRow(alpha, direction + at, x_ + at, size);
  }

  /// Returns false when the step was slow.
  bool minimalResidualStep() {
    multigrid_.apply(r_, z_.data());
    const Multigrid::Products products = multigrid_.applyOperator(z_.data(), p_.data(), r_);
    if (!(products.image > 0.0)) return false;
    const float alpha = static_cast<float>(products.withImage / products.image);
    const double square = length_ * length_ - products.withImage * products.withImage / products.image;
    const double foreseen = std::sqrt(std::max(square, 0.0));
    const bool last = foreseen <= target_ && foreseen >= kTrustedGain * length_;
    const double sum = sumOverChunks([&](std::size_t at, std::size_t size) {
      advance(alpha, z_.data(), at, size);
      if (last) return 0.0;
      kernels::addRow(-alpha, p_.data() + at, r_ + at, size);
      return kernels::dotRow(r_ + at, r_ + at, size);
    });
    const double before = length_;
    count(last ? foreseen : std::sqrt(sum));
    return length_ <= kSlowStep * before;
  }

  void conjugateGradients() {
    double rz = 0.0;
    for (bool start = true; !finished(); start = false) {
      const double previous = rz;
      multigrid_.apply(r_, z_.data());
      rz = sumOverChunks(
          [&](std::size_t at, std::size_t size) { return kernels::dotRow(r_ + at, z_.data() + at, size); });
      const float beta = start ? 0.0f : static_cast<float>(rz / previous);
      sumOverChunks([&](std::size_t at, std::size_t size) {
        kernels::scaleAndAdd(beta, z_.data() + at, p_.data() + at, size);
        return 0.0;
      });
      const double curvature = multigrid_.applyOperator(p_.data(), z_.data(), p_.data()).withImage;
      if (!(curvature > 0.0)) return;
      const float alpha = static_cast<float>(rz / curvature);
      count(std::sqrt(sumOverChunks([&](std::size_t at, std::size_t size) {
        advance(alpha, p_.data(), at, size);
        kernels::addRow(-alpha, z_.data() + at, r_ + at, size);
        return kernels::dotRow(r_ + at, r_ + at, size);
      })));
    }
  }

  Multigrid& multigrid_;
  float* r_;
  float* x_;
  bool fromZero_;
  double first_, length_, target_;
  int maxSteps_, steps_ = 0;
  Progress& progress_;
  FieldBuffer p_, z_;
};

}  // namespace

int krylovSolve(Multigrid& multigrid, float* r, float* x, bool fromZero, double length, double target, int maxSteps,
                Progress& progress) {
  return Iteration(multigrid, r, x, fromZero, length, target, maxSteps, progress).run();
}

}  // namespace stormfield
