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

/// Masses of the samples for every float of a row.
std::vector<float> interleavedMass(const LambdaGrid& lambda) {
  std::vector<float> mass(lambda.stride(), 0.0f);
  for (Index j = 0; j < lambda.samples(); ++j) mass[2 * j] = mass[2 * j + 1] = lambda.mass[j];
  return mass;
}

/// Which neighbours a row sees: in a first sweep from zero the later ones are zero.
enum class Neighbours { Earlier, All };

/// Gauss-Seidel on one level: x_row solves its line for the values of its neighbours.
class Relaxation {
 public:
  Relaxation(const SurfaceLevel& level, const float* inverse, const float* mass, const float* b, float* x,
             Neighbours neighbours)
      : level_(level),
        inverse_(inverse),
        mass_(mass),
        b_(b),
        x_(x),
        neighbours_(neighbours),
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
      kernels::store(both_.data() + 2 * k, kernels::shuffled<0, 1, 4, 5>(a, b));
      kernels::store(both_.data() + 2 * k + 4, kernels::shuffled<2, 3, 6, 7>(a, b));
    }
    const Index samples = level_.lambda.samples();
    kernels::solveTwoLines(inverse_ + static_cast<std::size_t>(row) * samples, level_.lambdaCoupling[row],
                           level_.lambdaCoupling[row + 1], samples, both_.data());
    float* own = x_ + row * stride_;
    for (std::size_t k = 0; k < stride_; k += 4) {
      const Vector low = kernels::load(both_.data() + 2 * k);
      const Vector high = kernels::load(both_.data() + 2 * k + 4);
      kernels::store(own + k, kernels::shuffled<0, 1, 4, 5>(low, high));
      kernels::store(own + stride_ + k, kernels::shuffled<2, 3, 6, 7>(low, high));
    }
  }

 private:
  /// out = b_row - mass * sum of couplings times neighbour rows.
  void gather(Index row, float* out) const {
    const Coupling* last = neighbours_ == Neighbours::All ? level_.couplings.end(row)
                                                          : level_.couplings.entries.data() + level_.split[row];
    kernels::rowSums().residual(level_.couplings.begin(row), last, x_, stride_, mass_, b_ + row * stride_, out);
  }

  const SurfaceLevel& level_;
  const float* inverse_;
  const float* mass_;
  const float* b_;
  float* x_;
  Neighbours neighbours_;
  std::size_t stride_;
  std::vector<float> first_, second_, both_;
};

}  // namespace

Multigrid::Multigrid(const SurfaceHierarchy& hierarchy) : hierarchy_(hierarchy), data_(hierarchy.levels.size()) {
  for (std::size_t l = 0; l < data_.size(); ++l) {
    const SurfaceLevel& level = hierarchy.levels[l];
    const std::size_t rows = static_cast<std::size_t>(level.rows());
    data_[l].mass = interleavedMass(level.lambda);
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

double Multigrid::apply(const float* r, float* z, const ChunkMask& skipped, const Progress& progress) {
  return cycle(0, r, z, skipped, progress);
}

bool Multigrid::besideOthers(Index chunk, const ChunkMask& skipped) const {
  const SurfaceLevel& level = finest();
  const Coupling* last = level.couplings.end(level.sweep.chunkStart[chunk + 1] - 1);
  return std::any_of(level.couplings.begin(level.sweep.chunkStart[chunk]), last,
                     [&](const Coupling& c) { return !skipped[chunkOf_[c.column]]; });
}

double Multigrid::cycle(std::size_t l, const float* b, float* x, const ChunkMask& skipped, const Progress& progress) {
  relaxForward(l, b, x, SweepStart::Zero, skipped, progress);
  if (l + 1 == data_.size()) {
    for (int s = 1; s < kLastLevelSweeps; ++s) {
      relaxBackward(l, b, x, skipped, progress);
      relaxForward(l, b, x, SweepStart::Values, skipped, progress);
    }
    return relaxBackward(l, b, x, skipped, progress);
  }
  restrictResidual(l, x, skipped, progress);
  cycle(l + 1, data_[l + 1].b.data(), data_[l + 1].x.data(), {}, progress);
  prolong(l, x, progress);
  return relaxBackward(l, b, x, skipped, progress);
}

void Multigrid::relaxForward(std::size_t l, const float* b, float* x, SweepStart start, const ChunkMask& skipped,
                             const Progress& progress) {
  const SurfaceLevel& level = hierarchy_.levels[l];
  const SweepOrder& sweep = level.sweep;
  const std::size_t stride = level.lambda.stride();
  const Neighbours neighbours = start == SweepStart::Zero ? Neighbours::Earlier : Neighbours::All;
  for (Index colour = 0; colour < sweep.colours(); ++colour) {
    forChunks(level, sweep.colourStart[colour], sweep.colourStart[colour + 1], progress, [&](Index chunk) {
      if (isSkipped(chunk, skipped)) {
        std::fill(x + sweep.chunkStart[chunk] * stride, x + sweep.chunkStart[chunk + 1] * stride, 0.0f);
        return;
      }
      Relaxation relax(level, data_[l].inverse.data(), data_[l].mass.data(), b, x, neighbours);
      for (Index i = sweep.chunkStart[chunk]; i < sweep.pairEnd[chunk]; i += 2) relax.pair(i, 1);
      for (Index i = sweep.pairEnd[chunk]; i < sweep.chunkStart[chunk + 1]; ++i) relax.single(i, 1);
    });
  }
}

double Multigrid::relaxBackward(std::size_t l, const float* b, float* x, const ChunkMask& skipped,
                                const Progress& progress) {
  const SurfaceLevel& level = hierarchy_.levels[l];
  const SweepOrder& sweep = level.sweep;
  const std::size_t stride = level.lambda.stride();
  std::vector<double> products(sweep.chunks(), 0.0);
  for (Index colour = sweep.colours() - 1; colour >= 0; --colour) {
    forChunks(level, sweep.colourStart[colour], sweep.colourStart[colour + 1], progress, [&](Index chunk) {
      if (isSkipped(chunk, skipped) && !besideOthers(chunk, skipped)) return;
      const Index first = sweep.chunkStart[chunk], last = sweep.chunkStart[chunk + 1];
      Relaxation relax(level, data_[l].inverse.data(), data_[l].mass.data(), b, x, Neighbours::All);
      for (Index i = last - 1; i >= sweep.pairEnd[chunk]; --i) relax.single(i, -1);
      for (Index i = sweep.pairEnd[chunk] - 2; i >= first; i -= 2) relax.pair(i, -1);
      if (l > 0) return;
      for (Index i = first; i < last; ++i) products[chunk] += kernels::dotRow(b + i * stride, x + i * stride, stride);
    });
  }
  return std::accumulate(products.begin(), products.end(), 0.0);
}

void Multigrid::clearHard(std::size_t l, Index row, float* values) const {
  if (l > 0 || !constraints_->anyHard) return;
  for (const auto* e = constraints_->begin(row); e != constraints_->end(row); ++e) {
    if (e->hard()) values[2 * e->sample] = values[2 * e->sample + 1] = 0.0f;
  }
}

void Multigrid::restrictResidual(std::size_t l, const float* x, const ChunkMask& skipped, const Progress& progress) {
  const SurfaceLevel &level = hierarchy_.levels[l], &next = hierarchy_.levels[l + 1];
  const SweepOrder& sweep = level.sweep;
  const CouplingRows& couplings = level.couplings;
  const Index samples = level.lambda.samples();
  const std::size_t stride = level.lambda.stride(), nextStride = next.lambda.stride();
  const bool halved = next.lambda.samples() != samples;
  LevelData& data = data_[l];
  // A row that was relaxed had no residual then: it is what the later rows changed since. A skipped one has that of
  // all.
  forAllChunks(level, progress, [&](Index chunk) {
    const bool isLeftOut = isSkipped(chunk, skipped);
    if (isLeftOut && !besideOthers(chunk, skipped)) {
      float* out = data.residual.data();
      std::fill(out + sweep.chunkStart[chunk] * nextStride, out + sweep.chunkStart[chunk + 1] * nextStride, 0.0f);
      return;
    }
    std::vector<float> line(stride);
    for (Index i = sweep.chunkStart[chunk]; i < sweep.chunkStart[chunk + 1]; ++i) {
      kernels::prefetchAhead(x, i, level.rows(), stride, 1);
      float* out = data.residual.data() + i * nextStride;
      float* to = halved ? line.data() : out;
      const Coupling* first = isLeftOut ? couplings.begin(i) : couplings.entries.data() + level.split[i];
      kernels::rowSums().residual(first, couplings.end(i), x, stride, data.mass.data(), nullptr, to);
      clearHard(l, i, to);
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
}

void Multigrid::prolong(std::size_t l, float* x, const Progress& progress) const {
  const SurfaceLevel& level = hierarchy_.levels[l];
  const LambdaGrid& coarse = hierarchy_.levels[l + 1].lambda;
  const Index samples = level.lambda.samples();
  const std::size_t stride = level.lambda.stride(), coarseStride = coarse.stride();
  const bool halved = coarse.samples() != samples;
  const float* from = data_[l + 1].x.data();
  forAllChunks(level, progress, [&](Index chunk) {
    std::vector<float> line(coarseStride);
    for (Index i = level.sweep.chunkStart[chunk]; i < level.sweep.chunkStart[chunk + 1]; ++i) {
      float* own = x + i * stride;
      const Coupling *first = level.prolongation.begin(i), *last = level.prolongation.end(i);
      if (halved) {
        kernels::rowSums().sum(first, last, from, coarseStride, line.data());
        addProlongedLambda(line.data(), samples, own);
      } else {
        kernels::rowSums().add(first, last, from, coarseStride, own);
      }
      clearHard(l, i, own);
    }
  });
}

}  // namespace stormfield
