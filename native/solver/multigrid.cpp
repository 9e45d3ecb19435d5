#include "solver/multigrid.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "solver/level_weights.h"
#include "solver/row_algebra.h"

namespace stormfield {
namespace {

using kernels::Coupling;
using kernels::Vector;

/// Levels with less work than this per sweep are not worth other threads.
constexpr std::size_t kSerialFloats = 1 << 15;
/// Symmetric sweeps on the last level, where every row is a component of its own unless coarsening stalled.
constexpr int kLastLevelSweeps = 2;

/// Calls body(chunk) for a range of chunks, in parallel, and stops when cancelled.
template <typename Body>
void forChunks(Index first, Index last, bool parallel, const Progress& progress, const Body& body) {
  auto checked = [&](Index chunk) {
    progress.check();
    body(chunk);
  };
  if (parallel) {
    tbb::parallel_for(first, last, checked);
  } else {
    for (Index chunk = first; chunk < last; ++chunk) checked(chunk);
  }
}

bool isParallel(const SurfaceLevel& level) {
  return static_cast<std::size_t>(level.rows()) * level.lambda.stride() >= kSerialFloats;
}

template <typename Body>
void forAllChunks(const SurfaceLevel& level, const Progress& progress, const Body& body) {
  forChunks(0, level.sweep.chunks(), isParallel(level), progress, body);
}

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
        both_(2 * stride_) {}

  void single(Index row) {
    float* own = x_ + row * stride_;
    gather(row, [&](std::size_t k, const Vector& value) { kernels::store(own + k, value); });
    const Index samples = level_.lambda.samples();
    kernels::solveLine(inverse_ + static_cast<std::size_t>(row) * samples, level_.lambdaCoupling[row], samples, own);
  }

  /// Rows row and row + 1, which share no edge.
  void pair(Index row) {
    gather(row, [&](std::size_t k, const Vector& value) { kernels::store(first_.data() + k, value); });
    gather(row + 1, [&](std::size_t k, const Vector& value) {
      const Vector other = kernels::load(first_.data() + k);
      kernels::store(both_.data() + 2 * k, __builtin_shufflevector(other, value, 0, 1, 4, 5));
      kernels::store(both_.data() + 2 * k + 4, __builtin_shufflevector(other, value, 2, 3, 6, 7));
    });
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
  /// Calls put(offset, b_row - mass * sum of couplings times neighbour rows).
  template <typename Put>
  void gather(Index row, const Put& put) const {
    const Coupling* last = whole_ ? level_.couplings.end(row) : level_.couplings.entries.data() + level_.split[row];
    const float* right = b_ + row * stride_;
    kernels::gatherRow(level_.couplings.begin(row), last, x_, stride_, [&](std::size_t k, const Vector& sum) {
      put(k, kernels::load(right + k) - kernels::load(mass_ + k) * sum);
    });
  }

  const SurfaceLevel& level_;
  const float* inverse_;
  const float* mass_;
  const float* b_;
  float* x_;
  bool whole_;
  std::size_t stride_;
  std::vector<float> first_, both_;
};

}  // namespace

Multigrid::Multigrid(const SurfaceHierarchy& hierarchy, const ConstraintRows& constraints, const Progress& progress)
    : hierarchy_(hierarchy), constraints_(constraints), progress_(progress), data_(hierarchy.levels.size()) {
  LevelWeights weights = finestWeights(constraints);
  for (std::size_t l = 0; l < data_.size(); ++l) {
    progress.check();
    const SurfaceLevel& level = hierarchy.levels[l];
    const std::size_t size = static_cast<std::size_t>(level.rows()) * level.lambda.stride();
    data_[l].inverse = inversePivots(level, weights);
    if (l > 0) {
      data_[l].x = FieldBuffer(size);
      data_[l].b = FieldBuffer(size);
    }
    if (l + 1 < data_.size()) {
      const LambdaGrid& next = hierarchy.levels[l + 1].lambda;
      data_[l].residual = FieldBuffer(static_cast<std::size_t>(level.rows()) * next.stride());
      weights = restricted(weights, level, next);
    }
  }
}

void Multigrid::apply(const float* r, float* z) {
  cycle(0, r, z);
}

Multigrid::Products Multigrid::applyOperator(const float* p, float* q, const float* with) const {
  const SurfaceLevel& level = hierarchy_.levels.front();
  const std::size_t stride = level.lambda.stride();
  const Index samples = level.lambda.samples();
  std::vector<Products> parts(level.sweep.chunks());
  forAllChunks(level, progress_, [&](Index chunk) {
    Products part;
    for (Index i = level.sweep.chunkStart[chunk]; i < level.sweep.chunkStart[chunk + 1]; ++i) {
      const float* own = p + i * stride;
      float* out = q + i * stride;
      const float k = level.lambdaCoupling[i];
      const float diagonal = level.diagonal[i] + 2.0f * k;
      kernels::gatherRow(level.couplings.begin(i), level.couplings.end(i), p, stride,
                         [&](std::size_t at, const Vector& sum) {
                           kernels::store(out + at, sum + diagonal * kernels::load(own + at));
                         });
      // The samples before and after; the ends have one each.
      for (Index t = 2; t < 2 * samples; ++t) out[t] -= k * own[t - 2];
      for (Index t = 0; t + 2 < 2 * samples; ++t) out[t] -= k * own[t + 2];
      for (Index t = 0; t < 2; ++t) {
        out[t] -= k * own[t];
        out[2 * samples - 2 + t] -= k * own[2 * samples - 2 + t];
      }
      for (const auto* e = constraints_.begin(i); e != constraints_.end(i); ++e) {
        for (Index t = 2 * e->sample; t < 2 * e->sample + 2; ++t) {
          out[t] = e->hard() ? 0.0f : out[t] + static_cast<float>(e->weight) * own[t];
        }
      }
      part.withImage += kernels::dotRow(with + i * stride, out, stride);
      part.image += kernels::dotRow(out, out, stride);
    }
    parts[chunk] = part;
  });
  Products sum;
  for (const Products& part : parts) {
    sum.withImage += part.withImage;
    sum.image += part.image;
  }
  return sum;
}

void Multigrid::cycle(std::size_t l, const float* b, float* x) {
  const SurfaceLevel& level = hierarchy_.levels[l];
  LevelData& data = data_[l];
  const SweepOrder& sweep = level.sweep;
  const CouplingRows& couplings = level.couplings;
  const Index samples = level.lambda.samples();
  const std::size_t stride = level.lambda.stride();
  const bool parallel = isParallel(level);
  const std::vector<float> mass = interleavedMass(level.lambda);
  const float* inverse = data.inverse.data();

  auto forward = [&](bool fromZero) {
    for (Index colour = 0; colour < sweep.colours(); ++colour) {
      forChunks(sweep.colourStart[colour], sweep.colourStart[colour + 1], parallel, progress_, [&](Index chunk) {
        Relaxation relax(level, inverse, mass.data(), b, x, !fromZero);
        for (Index i = sweep.chunkStart[chunk]; i < sweep.pairEnd[chunk]; i += 2) relax.pair(i);
        for (Index i = sweep.pairEnd[chunk]; i < sweep.chunkStart[chunk + 1]; ++i) relax.single(i);
      });
    }
  };
  auto backward = [&] {
    for (Index colour = sweep.colours() - 1; colour >= 0; --colour) {
      forChunks(sweep.colourStart[colour], sweep.colourStart[colour + 1], parallel, progress_, [&](Index chunk) {
        Relaxation relax(level, inverse, mass.data(), b, x, true);
        for (Index i = sweep.chunkStart[chunk + 1] - 1; i >= sweep.pairEnd[chunk]; --i) relax.single(i);
        for (Index i = sweep.pairEnd[chunk] - 2; i >= sweep.chunkStart[chunk]; i -= 2) relax.pair(i);
      });
    }
  };

  forward(true);
  if (l + 1 == data_.size()) {
    for (int s = 1; s < kLastLevelSweeps; ++s) {
      backward();
      forward(false);
    }
    backward();
    return;
  }

  const SurfaceLevel& next = hierarchy_.levels[l + 1];
  const std::size_t nextStride = next.lambda.stride();
  const bool halved = next.lambda.samples() != samples;
  auto clearHard = [&](Index row, float* values) {
    if (l > 0 || !constraints_.anyHard) return;
    for (const auto* e = constraints_.begin(row); e != constraints_.end(row); ++e) {
      if (e->hard()) values[2 * e->sample] = values[2 * e->sample + 1] = 0.0f;
    }
  };

  // After the forward sweep a row's residual is what the later rows changed since.
  forAllChunks(level, progress_, [&](Index chunk) {
    std::vector<float> line(stride);
    for (Index i = sweep.chunkStart[chunk]; i < sweep.chunkStart[chunk + 1]; ++i) {
      float* out = data.residual.data() + i * nextStride;
      float* to = halved ? line.data() : out;
      kernels::gatherRow(
          couplings.entries.data() + level.split[i], couplings.end(i), x, stride,
          [&](std::size_t k, const Vector& sum) { kernels::store(to + k, -kernels::load(mass.data() + k) * sum); });
      clearHard(i, to);
      if (halved) {
        std::fill(out + 2 * next.lambda.samples(), out + nextStride, 0.0f);
        restrictLambda(line.data(), samples, out);
      }
    }
  });
  forAllChunks(next, progress_, [&](Index chunk) {
    for (Index i = next.sweep.chunkStart[chunk]; i < next.sweep.chunkStart[chunk + 1]; ++i) {
      float* out = data_[l + 1].b.data() + i * nextStride;
      kernels::gatherRow(level.restriction.begin(i), level.restriction.end(i), data.residual.data(), nextStride,
                         [&](std::size_t k, const Vector& sum) { kernels::store(out + k, sum); });
    }
  });
  cycle(l + 1, data_[l + 1].b.data(), data_[l + 1].x.data());
  forAllChunks(level, progress_, [&](Index chunk) {
    std::vector<float> line(nextStride);
    for (Index i = sweep.chunkStart[chunk]; i < sweep.chunkStart[chunk + 1]; ++i) {
      float* own = x + i * stride;
      kernels::gatherRow(level.prolongation.begin(i), level.prolongation.end(i), data_[l + 1].x.data(), nextStride,
                         [&](std::size_t k, const Vector& sum) {
                           if (halved) {
                             kernels::store(line.data() + k, sum);
                           } else {
                             kernels::store(own + k, kernels::load(own + k) + sum);
                           }
                         });
      if (halved) addProlongedLambda(line.data(), samples, own);
      clearHard(i, own);
    }
  });
  backward();
}

}  // namespace stormfield
