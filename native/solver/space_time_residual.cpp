#include "solver/space_time_residual.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "solver/row_algebra.h"

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

/// One sample of some vertices to or from their rows. Functions of their own, because the compiler would otherwise make
/// the samples the inner loop, and every access a page of its own.
[[gnu::noinline]] void gatherSample(const Complex* slice, const std::vector<Index>& vertices, Complex* rows,
                                    std::size_t rowLength) {
  for (const Index v : vertices) {
    *rows = slice[v];
    rows += rowLength;
  }
}
[[gnu::noinline]] void gatherSample(const Complex* slice, const Index* vertices, Index count, double factor,
                                    float* rows, std::size_t rowLength) {
  for (Index i = 0; i < count; ++i, rows += rowLength) {
    rows[0] = static_cast<float>(factor * slice[vertices[i]].real());
    rows[1] = static_cast<float>(factor * slice[vertices[i]].imag());
  }
}
[[gnu::noinline]] void scatterSample(const Complex* rows, std::size_t rowLength, const Index* vertices, Index count,
                                     Complex* slice) {
  for (Index i = 0; i < count; ++i) slice[vertices[i]] = rows[i * rowLength];
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

double SpaceTimeResidual::evaluate(const ConstraintRows& constraints, const std::vector<char>& active, const Field& x,
                                   Complex* field, float* residual, double residualScale,
                                   const Progress& progress) const {
  const SurfaceMatrix& matrix = hierarchy_.matrix;
  const LambdaGrid& lambda = hierarchy_.levels.front().lambda;
  const Index samples = lambda.samples();
  const std::size_t stride = lambda.stride();
  const std::size_t padded = paddedSamples(samples);
  const std::size_t vertices = rowOf_.size();
  const SweepOrder& sweep = hierarchy_.finest;
  std::vector<double> squares(sweep.chunks(), 0.0);
  tbb::enumerable_thread_specific<Scratch> scratches;

  tbb::parallel_for(Index{0}, sweep.chunks(), [&](Index chunk) {
    progress.check();
    Scratch& scratch = scratches.local();
    const Index first = sweep.chunkStart[chunk];
    const Index own = sweep.chunkStart[chunk + 1] - first;
    const std::vector<Index> local = localRows(chunk);
    scratch.x.assign(local.size() * padded, Complex{});
    bool zero = !x.base && !x.correction;

    if (x.base) {
      std::vector<Index> from;
      for (const Index row : local) from.push_back(vertex_[row]);
      for (Index j = 0; j < samples; ++j) gatherSample(x.base + j * vertices, from, scratch.x.data() + j, padded);
    }
    for (std::size_t i = 0; i < local.size(); ++i) {
      const Index row = local[i];
      Complex* line = scratch.x.data() + i * padded;
      if (!active[row]) std::fill(line, line + samples, Complex{});
      if (x.correction && active[row]) {
        const float* add = x.correction + row * stride;
        for (Index j = 0; j < samples; ++j) line[j] += x.scale * Complex(add[2 * j], add[2 * j + 1]);
      }
      if (!constraints.anyHard) continue;
      for (const auto* e = constraints.begin(row); e != constraints.end(row); ++e) {
        if (!e->hard()) continue;
        line[e->sample] = e->pull;
        zero = false;
      }
    }
    if (field) {
      for (Index j = 0; j < samples; ++j) {
        scatterSample(scratch.x.data() + j, padded, vertex_.data() + first, own, field + j * vertices);
      }
    }

    scratch.residual.resize(2 * padded);
    double* r = scratch.residual.data();
    const double* values = reinterpret_cast<const double*>(scratch.x.data());
    for (Index i = 0; i < own; ++i) {
      const Index row = first + i;
      const double* v = values + i * 2 * padded;
      std::fill(scratch.residual.begin(), scratch.residual.end(), 0.0);
      if (!zero && active[row]) {
        scratch.couplings.clear();
        for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e) {
          scratch.couplings.push_back({localColumn_[e], matrix.value[e].real(), matrix.value[e].imag()});
        }
        const double diagonal = matrix.diagonal[row];
        kernels::gatherRow(scratch.couplings.data(), scratch.couplings.data() + scratch.couplings.size(), values,
                           2 * padded, [&](std::size_t k, const kernels::VectorOf<double>& sum) {
                             kernels::store(r + k, -sum - diagonal * kernels::load(v + k));
                           });
        const double k = lambdaCoupling_ * matrix.mass[row];
        for (Index t = 0; t < 2 * samples - 2; ++t) r[t] += k * (v[t + 2] - v[t]);
        for (Index t = 2; t < 2 * samples; ++t) r[t] += k * (v[t - 2] - v[t]);
      }
      for (const auto* e = constraints.begin(row); e != constraints.end(row); ++e) {
        const Index t = 2 * e->sample;
        r[t] = e->hard() ? 0.0 : r[t] + e->pull.real() - e->weight * v[t];
        r[t + 1] = e->hard() ? 0.0 : r[t + 1] + e->pull.imag() - e->weight * v[t + 1];
      }
      squares[chunk] += kernels::dotRow(r, r, 2 * padded);
      if (residual) {
        float* out = residual + row * stride;
        const double factor = 1.0 / residualScale;
        for (Index t = 0; t < 2 * samples; ++t) out[t] = static_cast<float>(factor * r[t]);
        std::fill(out + 2 * samples, out + stride, 0.0f);
      }
    }
  });
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0));
}

std::vector<Index> SpaceTimeResidual::localRows(Index chunk) const {
  std::vector<Index> rows(hierarchy_.finest.chunkStart[chunk + 1] - hierarchy_.finest.chunkStart[chunk]);
  std::iota(rows.begin(), rows.end(), hierarchy_.finest.chunkStart[chunk]);
  rows.insert(rows.end(), halo_.begin() + static_cast<std::ptrdiff_t>(haloStart_[chunk]),
              halo_.begin() + static_cast<std::ptrdiff_t>(haloStart_[chunk + 1]));
  return rows;
}

void SpaceTimeResidual::toRows(const Complex* field, double scale, float* correction, const Progress& progress) const {
  const LambdaGrid& lambda = hierarchy_.levels.front().lambda;
  const std::size_t stride = lambda.stride();
  tbb::parallel_for(Index{0}, hierarchy_.finest.chunks(), [&](Index chunk) {
    progress.check();
    const Index first = hierarchy_.finest.chunkStart[chunk];
    const Index last = hierarchy_.finest.chunkStart[chunk + 1];
    std::fill(correction + first * stride, correction + last * stride, 0.0f);
    for (Index j = 0; j < lambda.samples(); ++j) {
      gatherSample(field + static_cast<std::size_t>(j) * rowOf_.size(), vertex_.data() + first, last - first,
                   1.0 / scale, correction + first * stride + 2 * j, stride);
    }
  });
}

void SpaceTimeResidual::add(const float* correction, double scale, Complex* base, const Progress& progress) const {
  const LambdaGrid& lambda = hierarchy_.levels.front().lambda;
  const std::size_t stride = lambda.stride();
  tbb::parallel_for(Index{0}, hierarchy_.finest.chunks(), [&](Index chunk) {
    progress.check();
    for (Index j = 0; j < lambda.samples(); ++j) {
      Complex* slice = base + static_cast<std::size_t>(j) * rowOf_.size();
      for (Index row = hierarchy_.finest.chunkStart[chunk]; row < hierarchy_.finest.chunkStart[chunk + 1]; ++row) {
        const float* value = correction + row * stride + 2 * j;
        slice[vertex_[row]] += scale * Complex(value[0], value[1]);
      }
    }
  });
}

}  // namespace stormfield
