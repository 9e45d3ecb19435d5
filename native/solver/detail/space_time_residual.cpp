#include "solver/detail/space_time_residual.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "solver/detail/chunk_loop.h"
#include "solver/detail/row_algebra.h"

namespace stormfield {
namespace {

using Coupling = kernels::CouplingOf<double>;

/// Values of one chunk and its halo, a row per vertex, all samples.
struct Scratch {
  std::vector<Complex> x;
  std::vector<double> residual;
  std::vector<Coupling> couplings;
};

/// Samples in a row of doubles, padded with zeros to whole pairs.
std::size_t paddedSamples(Index samples) {
  return (static_cast<std::size_t>(samples) + 1) / 2 * 2;
}

/// One sample of some vertices to their rows. A function of its own, because the compiler would otherwise make
/// the samples the inner loop, and every access a page of its own.
[[gnu::noinline]] void gatherSample(const Complex* slice, const std::vector<Index>& vertices, Complex* rows,
                                    std::size_t rowLength) {
  for (const Index v : vertices) {
    *rows = slice[v];
    rows += rowLength;
  }
}

}  // namespace

SpaceTimeResidual::SpaceTimeResidual(const SurfaceHierarchy& hierarchy, double lambdaCoupling,
                                     std::vector<Index> vertex, Index meshVertices)
    : hierarchy_(hierarchy), lambdaCoupling_(lambdaCoupling), vertex_(std::move(vertex)), rowOf_(meshVertices, kNone) {
  for (std::size_t i = 0; i < vertex_.size(); ++i) rowOf_[vertex_[i]] = static_cast<Index>(i);
  const SurfaceMatrix& matrix = hierarchy.matrix;
  localColumn_.resize(matrix.column.size());
  std::vector<Index> local(matrix.rows(), kNone);
  haloStart_.push_back(0);
  for (Index chunk = 0; chunk < hierarchy.finest.chunks(); ++chunk) {
    const Index first = hierarchy.finest.chunkStart[chunk];
    const Index last = hierarchy.finest.chunkStart[chunk + 1];
    for (std::size_t k = matrix.start[first]; k < matrix.start[last]; ++k) {
      const Index column = matrix.column[k];
      if (column >= first && column < last) {
        localColumn_[k] = column - first;
        continue;
      }
      if (local[column] == kNone) {
        local[column] = last - first + static_cast<Index>(halo_.size() - haloStart_.back());
        halo_.push_back(column);
      }
      localColumn_[k] = local[column];
    }
    for (std::size_t k = haloStart_.back(); k < halo_.size(); ++k) local[halo_[k]] = kNone;
    haloStart_.push_back(halo_.size());
  }
}

double SpaceTimeResidual::rightSide(const ConstraintRows& constraints, const Progress& progress) const {
  double sum = 0.0;
  if (constraints.anyHard) {
    for (const double square : evaluate(constraints, nullptr, nullptr, 1.0, progress)) sum += square;
    return std::sqrt(sum);
  }
  for (Index row = 0; row < hierarchy_.matrix.rows(); ++row) {
    for (const auto* e = constraints.begin(row); e != constraints.end(row); ++e) sum += std::norm(e->pull);
  }
  return std::sqrt(sum);
}

std::vector<double> SpaceTimeResidual::evaluate(const ConstraintRows& constraints, const Complex* field,
                                                float* residual, double scale, const Progress& progress) const {
  const SurfaceMatrix& matrix = hierarchy_.matrix;
  const SurfaceLevel& level = hierarchy_.levels.front();
  const Index samples = level.lambda.samples();
  const std::size_t stride = level.lambda.stride();
  const std::size_t padded = paddedSamples(samples);
  tbb::enumerable_thread_specific<Scratch> scratches;
  std::vector<double> squares(level.sweep.chunks(), 0.0);
  forAllChunks(level, progress, [&](Index chunk) {
    Scratch& scratch = scratches.local();
    const Index first = level.sweep.chunkStart[chunk];
    const std::vector<Index> local = localRows(chunk);
    scratch.x.assign(local.size() * padded, Complex{});
    if (field) {
      std::vector<Index> from;
      for (const Index row : local) from.push_back(vertex_[row]);
      for (Index j = 0; j < samples; ++j) {
        gatherSample(field + j * rowOf_.size(), from, scratch.x.data() + j, padded);
      }
    }
    for (std::size_t i = 0; i < local.size(); ++i) {
      for (const auto* e = constraints.begin(local[i]); e != constraints.end(local[i]); ++e) {
        if (e->hard()) scratch.x[i * padded + e->sample] = e->pull;
      }
    }

    scratch.residual.resize(2 * padded);
    double* r = scratch.residual.data();
    const double* values = reinterpret_cast<const double*>(scratch.x.data());
    for (Index row = first; row < level.sweep.chunkStart[chunk + 1]; ++row) {
      const double* v = values + (row - first) * 2 * padded;
      std::fill(scratch.residual.begin(), scratch.residual.end(), 0.0);
      scratch.couplings.clear();
      for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e) {
        scratch.couplings.push_back({localColumn_[e], matrix.value[e].real(), matrix.value[e].imag()});
      }
      const double diagonal = matrix.diagonal[row];
      kernels::gatherRow<16>(scratch.couplings.data(), scratch.couplings.data() + scratch.couplings.size(), values,
                             2 * padded, [&](std::size_t k, const kernels::VectorOf<16, double>& sum) {
                               kernels::store(r + k, -sum - diagonal * kernels::load(v + k));
                             });
      const double k = lambdaCoupling_ * matrix.mass[row];
      for (Index t = 0; t < 2 * samples - 2; ++t) r[t] += k * (v[t + 2] - v[t]);
      for (Index t = 2; t < 2 * samples; ++t) r[t] += k * (v[t - 2] - v[t]);
      for (const auto* e = constraints.begin(row); e != constraints.end(row); ++e) {
        const Index t = 2 * e->sample;
        r[t] = e->hard() ? 0.0 : r[t] + e->pull.real() - e->weight * v[t];
        r[t + 1] = e->hard() ? 0.0 : r[t + 1] + e->pull.imag() - e->weight * v[t + 1];
      }
      squares[chunk] += kernels::dotRow(r, r, 2 * padded);
      if (residual) {
        float* out = residual + row * stride;
        const double factor = 1.0 / scale;
        for (Index t = 0; t < 2 * samples; ++t) out[t] = static_cast<float>(factor * r[t]);
        std::fill(out + 2 * samples, out + stride, 0.0f);
      }
    }
  });
  return squares;
}

std::vector<Index> SpaceTimeResidual::localRows(Index chunk) const {
  std::vector<Index> rows(hierarchy_.finest.chunkStart[chunk + 1] - hierarchy_.finest.chunkStart[chunk]);
  std::iota(rows.begin(), rows.end(), hierarchy_.finest.chunkStart[chunk]);
  rows.insert(rows.end(), halo_.begin() + static_cast<std::ptrdiff_t>(haloStart_[chunk]),
              halo_.begin() + static_cast<std::ptrdiff_t>(haloStart_[chunk + 1]));
  return rows;
}

/// Calls body(row, at in rows, at in field) for every vertex and sample, in tiles that the caches hold in both
/// layouts; row is kNone where there is none.
template <typename Body>
void SpaceTimeResidual::forValues(const Progress& progress, const Body& body) const {
  constexpr Index kVertices = 256, kSamples = 8;
  const Index vertices = static_cast<Index>(rowOf_.size());
  auto tile = [&](Index first, Index last, Index j, Index end) {
    for (; j < end; ++j) {
      const std::size_t slice = static_cast<std::size_t>(j) * vertices;
      for (Index v = first; v < last; ++v) body(rowOf_[v], rowOf_[v] * stride() + 2 * j, slice + v);
    }
  };
  tbb::parallel_for(Index{0}, (vertices + kVertices - 1) / kVertices, [&](Index block) {
    progress.check();
    const Index first = block * kVertices, last = std::min(vertices, first + kVertices);
    for (Index j = 0; j < samples(); j += kSamples) tile(first, last, j, std::min(samples(), j + kSamples));
  });
}

void SpaceTimeResidual::toRows(const Complex* field, double scale, float* rows, const Progress& progress) const {
  const double factor = 1.0 / scale;
  forValues(progress, [&](Index row, std::size_t at, std::size_t from) {
    if (row == kNone) return;
    rows[at] = static_cast<float>(factor * field[from].real());
    rows[at + 1] = static_cast<float>(factor * field[from].imag());
  });
  for (std::size_t row = 0; row < vertex_.size(); ++row) {
    std::fill(rows + row * stride() + 2 * samples(), rows + (row + 1) * stride(), 0.0f);
  }
}

void SpaceTimeResidual::toField(const ConstraintRows& constraints, const float* rows, double scale, Complex* field,
                                const Progress& progress) const {
  forValues(progress, [&](Index row, std::size_t at, std::size_t to) {
    field[to] = row == kNone ? Complex() : scale * Complex(rows[at], rows[at + 1]);
  });
  if (!constraints.anyHard) return;
  for (Index row = 0; row < hierarchy_.matrix.rows(); ++row) {
    for (const auto* e = constraints.begin(row); e != constraints.end(row); ++e) {
      if (e->hard()) field[e->sample * rowOf_.size() + vertex_[row]] = e->pull;
    }
  }
}

void SpaceTimeResidual::add(const float* rows, double scale, Complex* field, const Progress& progress) const {
  forValues(progress, [&](Index row, std::size_t at, std::size_t to) {
    if (row != kNone) field[to] += scale * Complex(rows[at], rows[at + 1]);
  });
}

}  // namespace stormfield
