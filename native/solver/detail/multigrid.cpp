#include "solver/detail/multigrid.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "solver/detail/chunk_loop.h"
#include "solver/detail/row_algebra.h"
#include "solver/detail/row_sums.h"

namespace stormfield {
namespace {

using kernels::Coupling;
using kernels::Vector;

/// Symmetric sweeps on the last level, where every row is a component of its own unless coarsening stalled.
constexpr int kLastLevelSweeps = 2;

/// Masses of the samples for every float of a row, or nothing where all are 1.
std::vector<float> interleavedMass(const LambdaGrid& lambda) {
  std::vector<float> mass(lambda.stride(), 0.0f);
  for (Index j = 0; j < lambda.samples(); ++j) mass[2 * j] = mass[2 * j + 1] = lambda.mass[j];
  return mass;
}

/// Gauss-Seidel on one level: x_row solves its line for the values of its neighbours. Rows `whole` see all neighbours,
/// else those before them only.
class Relaxation {
 public:
  Relaxation(const SurfaceLevel& level, const float* inverse, const float* mass, const float* b, float* x, bool whole)
      : level_(level),
        inverse_(inverse),
        mass_(mass),
        b_(b),
        x_(x),
        whole_(whole),
        stride_(level.lambda.stride()),
        first_(stride_),
        second_(stride_),
        both_(2 * stride_) {}

  void single(Index row, int direction) {
    kernels::prefetchAhead(x_, row, level_.rows(), stride_, direction);
    float* own = x_ + row * stride_;
    gather(row, own);
    const Index samples = level_.lambda.samples();
    kernels::solveLine(inverse_ + static_cast<std::size_t>(row) * samples, level_.lambdaCoupling[row], samples, own);
  }

  /// Rows row and row + 1, which share no edge.
  void pair(Index row, int direction) {
    kernels::prefetchAhead(x_, row, level_.rows(), stride_, direction);
    kernels::prefetchAhead(x_, row + 1, level_.rows(), stride_, direction);
    gather(row, first_.data());
    gather(row + 1, second_.data());
    for (std::size_t k = 0; k < stride_; k += 4) {
      const Vector a = kernels::load(first_.data() + k);
      const Vector b = kernels::load(second_.data() + k);
      kernels::store(both_.data() + 2 * k, __builtin_shufflevector(a, b, 0, 1, 4, 5));
      kernels::store(both_.data() + 2 * k + 4, __builtin_shufflevector(a, b, 2, 3, 6, 7));
    }
    const Index samples = level_.lambda.samples();
    kernels::solveTwoLines(inverse_ + static_cast<std::size_t>(row) * samples, level_.lambdaCoupling[row],
                           level_.lambdaCoupling[row + 1], samples, both_.data());
    float* own = x_ + row * stride_;
    for (std::size_t k = 0; k < stride_; k += 4) {
      const Vector low = kernels::load(both_.data() + 2 * k);
      const Vector high = kernels::load(both_.data() + 2 * k + 4);
      kernels::store(own + k, __builtin_shufflevector(low, high, 0, 1, 4, 5));
      kernels::store(own + stride_ + k, __builtin_shufflevector(low, high, 2, 3, 6, 7));
    }
  }

 private:
  /// out = b_row - mass * sum of couplings times neighbour rows.
  void gather(Index row, float* out) const {
    const Coupling* last = whole_ ? level_.couplings.end(row) : level_.couplings.entries.data() + level_.split[row];
    kernels::rowSums().residual(level_.couplings.begin(row), last, x_, stride_, mass_, b_ + row * stride_, out);
  }

  const SurfaceLevel& level_;
  const float* inverse_;
  const float* mass_;
  const float* b_;
  float* x_;
  bool whole_;
  std::size_t stride_;
  std::vector<float> first_, second_, both_;
};

}  // namespace

Multigrid::Multigrid(const SurfaceHierarchy& hierarchy) : hierarchy_(hierarchy), data_(hierarchy.levels.size()) {
  for (std::size_t l = 0; l < data_.size(); ++l) {
    const SurfaceLevel& level = hierarchy.levels[l];
    const std::size_t rows = static_cast<std::size_t>(level.rows());
    data_[l].inverse = FieldBuffer(rows * level.lambda.samples());
    if (l > 0) {
      data_[l].x = FieldBuffer(rows * level.lambda.stride());
      data_[l].b = FieldBuffer(rows * level.lambda.stride());
    }
    if (l + 1 < data_.size()) data_[l].residual = FieldBuffer(rows * hierarchy.levels[l + 1].lambda.stride());
  }
  const SweepOrder& sweep = finest().sweep;
  chunkOf_.resize(finest().rows());
  for (Index chunk = 0; chunk < sweep.chunks(); ++chunk) {
    std::fill(chunkOf_.begin() + sweep.chunkStart[chunk], chunkOf_.begin() + sweep.chunkStart[chunk + 1], chunk);
  }
}

void Multigrid::constrain(const ConstraintRows& constraints, const Progress& progress) {
  constraints_ = &constraints;
  LevelWeights weights = finestWeights(constraints);
  for (std::size_t l = 0; l < data_.size(); ++l) {
    progress.check();
    const SurfaceLevel& level = hierarchy_.levels[l];
    // Taken out first: a solve that is cancelled here leaves no weights, and the next one factorises all lines.
    const LevelWeights before = std::exchange(data_[l].weights, {});
    updatePivots(level, weights, before, data_[l].inverse.data());
    LevelWeights next;
    if (l + 1 < data_.size()) next = restricted(weights, level, hierarchy_.levels[l + 1].lambda);
    data_[l].weights = std::exchange(weights, std::move(next));
  }
}

double Multigrid::apply(const float* r, float* z, const std::vector<char>& silent, const Progress& progress) {
  return cycle(0, r, z, silent, progress);
}

bool Multigrid::touched(Index chunk, const std::vector<char>& silent) const {
  const SurfaceLevel& level = finest();
  const kernels::Coupling* last = level.couplings.end(level.sweep.chunkStart[chunk + 1] - 1);
  return std::any_of(level.couplings.begin(level.sweep.chunkStart[chunk]), last,
                     [&](const kernels::Coupling& c) { return !silent[chunkOf_[c.column]]; });
}

double Multigrid::cycle(std::size_t l, const float* b, float* x, const std::vector<char>& silent,
                        const Progress& progress) {
  const SurfaceLevel& level = hierarchy_.levels[l];
  LevelData& data = data_[l];
  const SweepOrder& sweep = level.sweep;
  const CouplingRows& couplings = level.couplings;
  const Index samples = level.lambda.samples();
  const std::size_t stride = level.lambda.stride();
  const bool parallel = isParallel(level);
  const std::vector<float> mass = interleavedMass(level.lambda);
  const float* inverse = data.inverse.data();
  auto isSilent = [&](Index chunk) { return !silent.empty() && silent[chunk]; };

  auto forward = [&](bool fromZero) {
    for (Index colour = 0; colour < sweep.colours(); ++colour) {
      forChunks(sweep.colourStart[colour], sweep.colourStart[colour + 1], parallel, progress, [&](Index chunk) {
        if (isSilent(chunk)) {
          std::fill(x + sweep.chunkStart[chunk] * stride, x + sweep.chunkStart[chunk + 1] * stride, 0.0f);
          return;
        }
        Relaxation relax(level, inverse, mass.data(), b, x, !fromZero);
        for (Index i = sweep.chunkStart[chunk]; i < sweep.pairEnd[chunk]; i += 2) relax.pair(i, 1);
        for (Index i = sweep.pairEnd[chunk]; i < sweep.chunkStart[chunk + 1]; ++i) relax.single(i, 1);
      });
    }
  };
  std::vector<double> products(sweep.chunks(), 0.0);
  auto backward = [&] {
    for (Index colour = sweep.colours() - 1; colour >= 0; --colour) {
      forChunks(sweep.colourStart[colour], sweep.colourStart[colour + 1], parallel, progress, [&](Index chunk) {
        if (isSilent(chunk) && !touched(chunk, silent)) return;
        Relaxation relax(level, inverse, mass.data(), b, x, true);
        for (Index i = sweep.chunkStart[chunk + 1] - 1; i >= sweep.pairEnd[chunk]; --i) relax.single(i, -1);
        for (Index i = sweep.pairEnd[chunk] - 2; i >= sweep.chunkStart[chunk]; i -= 2) relax.pair(i, -1);
        if (l > 0) return;
        const Index first = sweep.chunkStart[chunk], last = sweep.chunkStart[chunk + 1];
        for (Index i = first; i < last; ++i) {
          products[chunk] += kernels::dotRow(b + i * stride, x + i * stride, stride);
        }
      });
    }
  };
  auto product = [&] { return std::accumulate(products.begin(), products.end(), 0.0); };

  forward(true);
  if (l + 1 == data_.size()) {
    for (int s = 1; s < kLastLevelSweeps; ++s) {
      backward();
      forward(false);
    }
    products.assign(products.size(), 0.0);
    backward();
    return product();
  }

  const SurfaceLevel& next = hierarchy_.levels[l + 1];
  const std::size_t nextStride = next.lambda.stride();
  const bool halved = next.lambda.samples() != samples;
  auto clearHard = [&](Index row, float* values) {
    if (l > 0 || !constraints_->anyHard) return;
    for (const auto* e = constraints_->begin(row); e != constraints_->end(row); ++e) {
      if (e->hard()) values[2 * e->sample] = values[2 * e->sample + 1] = 0.0f;
    }
  };

  // After the forward sweep a row's residual is what the later rows changed since; in silent chunks, what all did.
  forAllChunks(level, progress, [&](Index chunk) {
    const bool quiet = isSilent(chunk);
    if (quiet && !touched(chunk, silent)) {
      float* out = data.residual.data();
      std::fill(out + sweep.chunkStart[chunk] * nextStride, out + sweep.chunkStart[chunk + 1] * nextStride, 0.0f);
      return;
    }
    std::vector<float> line(stride);
    for (Index i = sweep.chunkStart[chunk]; i < sweep.chunkStart[chunk + 1]; ++i) {
      kernels::prefetchAhead(x, i, level.rows(), stride, 1);
      float* out = data.residual.data() + i * nextStride;
      float* to = halved ? line.data() : out;
      const Coupling* first = quiet ? couplings.begin(i) : couplings.entries.data() + level.split[i];
      kernels::rowSums().residual(first, couplings.end(i), x, stride, mass.data(), nullptr, to);
      clearHard(i, to);
      if (halved) {
        std::fill(out + 2 * next.lambda.samples(), out + nextStride, 0.0f);
        restrictLambda(line.data(), samples, out);
      }
    }
  });
  forAllChunks(next, progress, [&](Index chunk) {
    for (Index i = next.sweep.chunkStart[chunk]; i < next.sweep.chunkStart[chunk + 1]; ++i) {
      kernels::rowSums().sum(level.restriction.begin(i), level.restriction.end(i), data.residual.data(), nextStride,
                             data_[l + 1].b.data() + i * nextStride);
    }
  });
  cycle(l + 1, data_[l + 1].b.data(), data_[l + 1].x.data(), {}, progress);
  forAllChunks(level, progress, [&](Index chunk) {
    std::vector<float> line(nextStride);
    for (Index i = sweep.chunkStart[chunk]; i < sweep.chunkStart[chunk + 1]; ++i) {
      float* own = x + i * stride;
      const Coupling* first = level.prolongation.begin(i);
      const Coupling* last = level.prolongation.end(i);
      if (halved) {
        kernels::rowSums().sum(first, last, data_[l + 1].x.data(), nextStride, line.data());
        addProlongedLambda(line.data(), samples, own);
      } else {
        kernels::rowSums().add(first, last, data_[l + 1].x.data(), nextStride, own);
      }
      clearHard(i, own);
    }
  });
  backward();
  return product();
}

}  // namespace stormfield
