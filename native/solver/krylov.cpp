#include "solver/krylov.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "solver/chunk_loop.h"
#include "solver/row_algebra.h"

namespace stormfield {
namespace {

/// A minimal-residual step that leaves more than this of the residual was the last of its kind.
constexpr double kSlowStep = 0.5;
/// The length of the next residual follows from inner products when it is no shorter than this part of the last one;
/// below, their rounding shows.
constexpr double kTrustedGain = 0.03;
/// Part of the residual that a minimal-residual step may leave alone, where that saves work.
constexpr double kSilentPart = 3e-3;

double lengthOf(const std::vector<double>& squares) {
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0));
}

class Iteration {
 public:
  Iteration(Multigrid& multigrid, const SpaceTimeOperator& matrix, KrylovVectors& vectors, std::vector<double> squares,
            double target, int maxSteps, Progress& progress)
      : multigrid_(multigrid),
        matrix_(matrix),
        x_(vectors.x.data()),
        r_(vectors.r.data()),
        z_(vectors.z.data()),
        p_(vectors.p.data()),
        squares_(std::move(squares)),
        first_(lengthOf(squares_)),
        length_(first_),
        target_(target),
        maxSteps_(maxSteps),
        progress_(progress) {}

  int run() {
    while (!finished() && minimalResidualStep()) {
    }
    conjugateGradients();
    return steps_;
  }

 private:
  bool finished() const { return length_ <= target_ || steps_ >= maxSteps_; }

  /// Keeps what body(offset, floats) returns per chunk.
  template <typename Body>
  void forFloats(std::vector<double>& parts, const Body& body) const {
    const SurfaceLevel& level = multigrid_.finest();
    const std::size_t stride = level.lambda.stride();
    parts.resize(level.sweep.chunks());
    forAllChunks(level, progress_, [&](Index chunk) {
      const std::size_t begin = level.sweep.chunkStart[chunk] * stride;
      parts[chunk] = body(begin, level.sweep.chunkStart[chunk + 1] * stride - begin);
    });
  }

  void count(double length) {
    length_ = length;
    ++steps_;
    progress_.report(std::clamp(std::log(length_ / first_) / std::log(target_ / first_), 0.0, 1.0));
  }

  /// Chunks that are passed over in the first half of a cycle: the smallest residuals, together a small part of all.
  std::vector<char> silentChunks() const {
    std::vector<Index> order(squares_.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](Index a, Index b) { return std::pair(squares_[a], a) < std::pair(squares_[b], b); });
    std::vector<char> silent(squares_.size(), 0);
    double sum = 0.0;
    for (const Index chunk : order) {
      sum += squares_[chunk];
      if (sum > kSilentPart * kSilentPart * length_ * length_) break;
      silent[chunk] = 1;
    }
    return silent;
  }

  /// Returns false when the step was slow.
  bool minimalResidualStep() {
    multigrid_.apply(r_, z_, silentChunks(), progress_);
    const SpaceTimeOperator::Products products = matrix_.apply(z_, p_, r_, progress_);
    if (!(products.image > 0.0)) return false;
    const float alpha = static_cast<float>(products.withImage / products.image);
    const double square = length_ * length_ - products.withImage * products.withImage / products.image;
    const double foreseen = std::sqrt(std::max(square, 0.0));
    const bool last = foreseen <= target_ && foreseen >= kTrustedGain * length_;
    forFloats(squares_, [&](std::size_t at, std::size_t size) {
      kernels::addRow(alpha, z_ + at, x_ + at, size);
      if (last) return 0.0;
      kernels::addRow(-alpha, p_ + at, r_ + at, size);
      return kernels::dotRow(r_ + at, r_ + at, size);
    });
    const double before = length_;
    count(last ? foreseen : lengthOf(squares_));
    return length_ <= kSlowStep * before;
  }

  void conjugateGradients() {
    std::vector<double> parts;
    double rz = 0.0;
    for (bool start = true; !finished(); start = false) {
      const double previous = rz;
      multigrid_.apply(r_, z_, {}, progress_);
      forFloats(parts, [&](std::size_t at, std::size_t size) { return kernels::dotRow(r_ + at, z_ + at, size); });
      rz = std::accumulate(parts.begin(), parts.end(), 0.0);
      const float beta = start ? 0.0f : static_cast<float>(rz / previous);
      forFloats(parts, [&](std::size_t at, std::size_t size) {
        kernels::scaleAndAdd(beta, z_ + at, p_ + at, size);
        return 0.0;
      });
      const double curvature = matrix_.apply(p_, z_, p_, progress_).withImage;
      if (!(curvature > 0.0)) return;
      const float alpha = static_cast<float>(rz / curvature);
      forFloats(squares_, [&](std::size_t at, std::size_t size) {
        kernels::addRow(alpha, p_ + at, x_ + at, size);
        kernels::addRow(-alpha, z_ + at, r_ + at, size);
        return kernels::dotRow(r_ + at, r_ + at, size);
      });
      count(lengthOf(squares_));
    }
  }

  Multigrid& multigrid_;
  const SpaceTimeOperator& matrix_;
  float *x_, *r_, *z_, *p_;
  std::vector<double> squares_;  ///< of r per chunk
  double first_, length_, target_;
  int maxSteps_, steps_ = 0;
  Progress& progress_;
};

}  // namespace

int krylovSolve(Multigrid& multigrid, const SpaceTimeOperator& matrix, KrylovVectors& vectors,
                std::vector<double> squares, double target, int maxSteps, Progress& progress) {
  vectors.z = FieldBuffer(vectors.x.size());
  vectors.p = FieldBuffer(vectors.x.size());
  const int steps = Iteration(multigrid, matrix, vectors, std::move(squares), target, maxSteps, progress).run();
  vectors.z = FieldBuffer();
  vectors.p = FieldBuffer();
  return steps;
}

}  // namespace stormfield
