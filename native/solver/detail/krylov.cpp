#include "solver/detail/krylov.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "solver/detail/chunk_loop.h"
#include "solver/detail/row_algebra.h"

namespace stormfield {
namespace {

/// The length of the next residual follows from inner products when it is no shorter than this fraction of the last
/// one; below, their rounding shows.
constexpr double kTrustedGain = 0.03;
/// Fraction of the first residual that the first step may leave out, where that saves work.
constexpr double kSkippedFraction = 3e-3;
/// No step is trusted to leave less than this fraction of the error, nor the first one less than half.
constexpr double kBestGain = 0.15;
constexpr double kFirstGain = 0.5;

class Iteration {
 public:
  Iteration(Multigrid& multigrid, const SpaceTimeOperator& matrix, KrylovVectors& vectors, std::vector<double> squares,
            const KrylovGoal& goal, Progress& progress)
      : multigrid_(multigrid),
        matrix_(matrix),
        x_(vectors.x.data()),
        r_(vectors.r.data()),
        z_(static_cast<float*>(vectors.work.data())),
        p_(z_ + vectors.x.size()),
        squares_(std::move(squares)),
        first_(lengthOf(squares_)),
        length_(first_),
        goal_(goal),
        progress_(progress) {}

  KrylovOutcome run() {
    while (step() && !met() && outcome_.steps < goal_.maxSteps) {
    }
    return outcome_;
  }

 private:
  bool met() const { return length_ <= goal_.residual && outcome_.error <= goal_.error; }

  /// Chunks that the sweeps of the first cycle leave out: the smallest residuals, together kSkippedFraction of the
  /// whole.
  Multigrid::ChunkMask skippedChunks() const {
    std::vector<Index> order(squares_.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](Index a, Index b) { return std::pair(squares_[a], a) < std::pair(squares_[b], b); });
    Multigrid::ChunkMask skipped(squares_.size(), 0);
    double sum = 0.0;
    for (const Index chunk : order) {
      sum += squares_[chunk];
      if (sum > kSkippedFraction * kSkippedFraction * length_ * length_) break;
      skipped[chunk] = 1;
    }
    return skipped;
  }

  /// p = M r, conjugate to the last p.
  void nextDirection() {
    if (outcome_.steps == 0) {
      multigrid_.apply(r_, p_, skippedChunks(), progress_);
      return;
    }
    const float beta = static_cast<float>(multigrid_.apply(r_, z_, {}, progress_) / products_.residualStep);
    const SurfaceLevel& level = multigrid_.finest();
    const std::size_t stride = level.lambda.stride();
    forAllChunks(level, progress_, [&](Index chunk) {
      const std::size_t at = level.sweep.chunkStart[chunk] * stride;
      kernels::scaleAndAdd(beta, z_ + at, p_ + at, level.sweep.chunkStart[chunk + 1] * stride - at);
    });
  }

  /// Length of r - alpha A p.
  double predictedLength(double alpha) const {
    const double square = length_ * length_ - alpha * (2.0 * products_.residualImage - alpha * products_.imageImage);
    return std::sqrt(std::max(square, 0.0));
  }
  bool reaches(double alpha) const {
    return predictedLength(alpha) <= goal_.residual && predictedLength(alpha) >= kTrustedGain * length_;
  }

  /// Of x after the step alpha p, relative to x as long as it was last time; infinite where that is not known.
  double estimatedError(double stepLength) const {
    const double gain = lastStep_ == 0.0 ? kFirstGain : std::max(kBestGain, stepLength / lastStep_);
    if (gain >= 1.0 || solution_ == 0.0) return std::numeric_limits<double>::infinity();
    return stepLength * gain / (1.0 - gain) / solution_;
  }

  /// x += alpha p; r -= alpha q, unless this is the last step. Takes their lengths.
  void advance(double alpha, const float* q, bool last) {
    const SurfaceLevel& level = multigrid_.finest();
    const std::size_t stride = level.lambda.stride();
    std::vector<double> solution(squares_.size(), 0.0);
    forAllChunks(level, progress_, [&](Index chunk) {
      double square = 0.0;
      for (Index i = level.sweep.chunkStart[chunk]; i < level.sweep.chunkStart[chunk + 1]; ++i) {
        const std::size_t at = i * stride;
        kernels::addRow(static_cast<float>(alpha), p_ + at, x_ + at, stride);
        if (last) continue;
        solution[chunk] += matrix_.mass(i) * kernels::dotRow(x_ + at, x_ + at, stride);
        kernels::addRow(static_cast<float>(-alpha), q + at, r_ + at, stride);
        square += kernels::dotRow(r_ + at, r_ + at, stride);
      }
      squares_[chunk] = square;
    });
    length_ = last ? predictedLength(alpha) : lengthOf(squares_);
    if (!last) solution_ = lengthOf(solution);
  }

  /// Returns false when there is nothing left to gain.
  bool step() {
    nextDirection();
    float* q = z_;
    products_ = matrix_.apply(p_, q, r_, progress_);
    if (!(products_.stepImage > 0.0)) {
      if (products_.stepStep == 0.0) outcome_.error = 0.0;
      return false;
    }
    double alpha = products_.residualStep / products_.stepImage;
    const double minimizing = products_.residualImage / products_.imageImage;
    const double stepLength = std::abs(alpha) * std::sqrt(products_.stepStep);
    const bool exact = estimatedError(stepLength) <= goal_.error;
    if (exact && !reaches(alpha) && reaches(minimizing)) alpha = minimizing;
    advance(alpha, q, exact && reaches(alpha));
    outcome_.error = estimatedError(stepLength);
    lastStep_ = stepLength;
    ++outcome_.steps;
    progress_.report(
        std::clamp(std::log(length_ / first_) / std::log(std::min(0.5, goal_.residual / first_)), 0.0, 1.0));
    return true;
  }

  Multigrid& multigrid_;
  const SpaceTimeOperator& matrix_;
  float *x_, *r_, *z_, *p_;
  std::vector<double> squares_;  ///< of r per chunk
  double first_, length_;
  double solution_ = 0.0;  ///< length of x in the mean square over surface and lambda, 0 before it is known
  double lastStep_ = 0.0;
  SpaceTimeOperator::Products products_;
  KrylovGoal goal_;
  KrylovOutcome outcome_{0, std::numeric_limits<double>::infinity()};
  Progress& progress_;
};

}  // namespace

KrylovOutcome krylovSolve(Multigrid& multigrid, const SpaceTimeOperator& matrix, KrylovVectors& vectors,
                          std::vector<double> squares, const KrylovGoal& goal, Progress& progress) {
  const std::size_t bytes = 2 * vectors.x.size() * sizeof(float);
  if (vectors.work.bytes() < bytes) vectors.work = Pages(bytes);
  return Iteration(multigrid, matrix, vectors, std::move(squares), goal, progress).run();
}

}  // namespace stormfield
