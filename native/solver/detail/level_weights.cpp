#include "solver/detail/level_weights.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace stormfield {
namespace {

constexpr Index kBlock = 256;

/// No weight larger than this times the diagonal is restricted: where a weight is much larger than the couplings of the
/// surface, the fine levels hold the value, and coarser ones would spread the weight to the neighbours. Chosen by the
/// error after 3 steps (docs/performance.md).
constexpr double kMaxWeight = 1.3;

/// Pivots below this fraction of the diagonal are zero: a line without constraint on a surface without curvature.
constexpr double kMinPivot = 1e-12;

double guardedInverse(double pivot, double diagonal) {
  return pivot > kMinPivot * diagonal && std::isfinite(diagonal) ? 1.0 / pivot : 0.0;
}

/// The part of each weight that is restricted to the coarser levels.
std::vector<double> limited(const LevelWeights& weights, const SurfaceLevel& level) {
  std::vector<double> result(weights.entries.size());
  tbb::parallel_for(tbb::blocked_range<Index>(0, level.rows(), kBlock), [&](const auto& range) {
    for (Index i = range.begin(); i != range.end(); ++i) {
      const double limit = kMaxWeight * level.diagonal[i];
      for (std::size_t k = weights.start[i]; k < weights.start[i + 1]; ++k) {
        const auto [j, weight] = weights.entries[k];
        const double bound = limit * level.lambda.mass[j];
        result[k] = std::isinf(weight) ? bound : weight * bound / (weight + bound);
      }
    }
  });
  return result;
}

}  // namespace

LevelWeights finestWeights(const ConstraintRows& constraints) {
  LevelWeights result;
  const std::size_t rows = constraints.start.size();
  result.start.reserve(rows + 1);
  for (std::size_t i = 0; i < rows; ++i) {
    result.start.push_back(result.start.back() + constraints.stop[i] - constraints.start[i]);
  }
  result.entries.resize(result.start.back());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows, 512), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      LevelWeights::Entry* out = result.entries.data() + result.start[i];
      for (std::size_t k = constraints.start[i]; k < constraints.stop[i]; ++k) {
        *out++ = {constraints.entries[k].sample, constraints.entries[k].weight};
      }
    }
  });
  return result;
}

LevelWeights restricted(const LevelWeights& fine, const SurfaceLevel& from, const LambdaGrid& to) {
  const Index rows = static_cast<Index>(from.restriction.start.size()) - 1;
  const Index fineSamples = from.lambda.samples();
  const bool halved = to.samples() != fineSamples;
  const std::vector<double> restrictedWeight = limited(fine, from);
  std::vector<LevelWeights> blocks((rows + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
    std::vector<double> line(to.samples(), 0.0);
    const Index first = static_cast<Index>(block) * kBlock;
    for (Index row = first; row < std::min(rows, first + kBlock); ++row) {
      bool any = false;
      for (const kernels::Coupling* c = from.restriction.begin(row); c != from.restriction.end(row); ++c) {
        const double share = std::sqrt(c->re * c->re + c->im * c->im);
        for (std::size_t k = fine.start[c->column]; k < fine.start[c->column + 1]; ++k) {
          const Index j = fine.entries[k].sample;
          const double w = share * restrictedWeight[k];
          any = true;
          if (!halved) {
            line[j] += w;
          } else if (j % 2 == 0 || j + 1 == fineSamples) {
            line[j / 2] += w;
          } else {
            line[j / 2] += 0.5 * w;
            line[j / 2 + 1] += 0.5 * w;
          }
        }
      }
      if (any) {
        for (Index j = 0; j < to.samples(); ++j) {
          if (line[j] != 0.0) blocks[block].entries.push_back({j, line[j]});
          line[j] = 0.0;
        }
      }
      blocks[block].start.push_back(blocks[block].entries.size());
    }
  });
  LevelWeights result;
  result.start.reserve(rows + 1);
  for (const LevelWeights& block : blocks) {
    const std::size_t offset = result.entries.size();
    result.entries.insert(result.entries.end(), block.entries.begin(), block.entries.end());
    for (std::size_t k = 1; k < block.start.size(); ++k) result.start.push_back(offset + block.start[k]);
  }
  return result;
}

void updatePivots(const SurfaceLevel& level, const LevelWeights& weights, const LevelWeights& before, float* inverse) {
  const LambdaGrid& lambda = level.lambda;
  const Index samples = lambda.samples();
  const Index middle = samples / 2;
  const bool any = before.start.size() == weights.start.size();
  auto unchanged = [&](Index i) {
    return any && std::equal(weights.entries.begin() + static_cast<std::ptrdiff_t>(weights.start[i]),
                             weights.entries.begin() + static_cast<std::ptrdiff_t>(weights.start[i + 1]),
                             before.entries.begin() + static_cast<std::ptrdiff_t>(before.start[i]),
                             before.entries.begin() + static_cast<std::ptrdiff_t>(before.start[i + 1]));
  };
  tbb::parallel_for(Index{0}, level.sweep.chunks(), [&](Index chunk) {
    std::vector<double> pivot(samples);
    const Index first = level.sweep.chunkStart[chunk];
    for (Index i = first; i < level.sweep.chunkStart[chunk + 1]; ++i) {
      if (unchanged(i)) continue;
      const double k = level.lambdaCoupling[i];
      for (Index j = 0; j < samples; ++j) {
        pivot[j] = static_cast<double>(level.diagonal[i]) * lambda.mass[j] + k * ((j > 0) + (j + 1 < samples));
      }
      for (std::size_t e = weights.start[i]; e < weights.start[i + 1]; ++e) {
        pivot[weights.entries[e].sample] += weights.entries[e].weight;
      }
      // The two rows of a pair alternate in memory.
      const bool pair = i < level.sweep.pairEnd[chunk];
      const Index even = pair ? i - (i - first) % 2 : i;
      float* out = inverse + static_cast<std::size_t>(even) * samples + (i - even);
      const Index step = pair ? 2 : 1;
      // Away from constraints the pivots soon repeat, and the division can be left out.
      double lastPivot = -1.0, lastTaken = 0.0, reciprocal = 0.0;
      auto eliminate = [&](Index j, double taken) {
        if (pivot[j] != lastPivot || std::abs(taken - lastTaken) > 1e-10 * lastPivot) {
          reciprocal = guardedInverse(pivot[j] - taken, pivot[j]);
          lastPivot = pivot[j];
          lastTaken = taken;
        }
        out[j * step] = static_cast<float>(reciprocal);
        return k * k * reciprocal;
      };
      double above = 0.0;
      for (Index j = 0; j < middle; ++j) above = eliminate(j, above);
      double below = 0.0;
      for (Index j = samples - 1; j > middle; --j) below = eliminate(j, below);
      eliminate(middle, above + below);
    }
  });
}

}  // namespace stormfield
