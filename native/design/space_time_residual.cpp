#include "design/space_time_residual.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace stormfield {
namespace {

struct Scratch {
  std::vector<Complex> x;  ///< rows of the chunk, then its halo; all samples
  std::vector<double> real, imaginary;
};

/// sums += entry times neighbour, kept as two sums so that the inner loop is two plain additions of scaled rows.
void addCoupling(Complex entry, const Complex* neighbour, Index samples, double* real, double* imaginary) {
  const double* x = reinterpret_cast<const double*>(neighbour);
  const double a = entry.real();
  const double b = entry.imag();
  for (Index t = 0; t < 2 * samples; ++t) {
    real[t] += a * x[t];
    imaginary[t] += b * x[t];
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

double SpaceTimeResidual::evaluate(const ConstraintRows& constraints, const std::vector<char>& active, const Field& x,
                                   Complex* field, float* residual, double residualScale,
                                   const Progress& progress) const {
  const SurfaceMatrix& matrix = hierarchy_.matrix;
  const LambdaGrid& lambda = hierarchy_.levels.front().lambda;
  const Index samples = lambda.samples();
  const std::size_t stride = lambda.stride();
  const std::size_t vertices = rowOf_.size();
  std::vector<double> squares(hierarchy_.finest.chunks(), 0.0);
  tbb::enumerable_thread_specific<Scratch> scratches;
  tbb::parallel_for(Index{0}, hierarchy_.finest.chunks(), [&](Index chunk) {
    progress.check();
    Scratch& scratch = scratches.local();
    const Index first = hierarchy_.finest.chunkStart[chunk];
    const Index own = hierarchy_.finest.chunkStart[chunk + 1] - first;
    const Index halo = static_cast<Index>(haloStart_[chunk + 1] - haloStart_[chunk]);
    auto rowAt = [&](Index local) { return local < own ? first + local : halo_[haloStart_[chunk] + (local - own)]; };
    scratch.x.resize(static_cast<std::size_t>(own + halo) * samples);
    scratch.real.resize(2 * samples);
    scratch.imaginary.resize(2 * samples);
    bool zero = !x.base && !x.correction;
    if (x.base) {
      for (Index j = 0; j < samples; ++j) {
        const Complex* slice = x.base + j * vertices;
        for (Index i = 0; i < own + halo; ++i) {
          scratch.x[static_cast<std::size_t>(i) * samples + j] = slice[vertex_[rowAt(i)]];
        }
      }
    } else {
      std::fill(scratch.x.begin(), scratch.x.end(), Complex{});
    }
    for (Index i = 0; i < own + halo; ++i) {
      const Index row = rowAt(i);
      Complex* line = scratch.x.data() + static_cast<std::size_t>(i) * samples;
      if (!active[row]) {
        std::fill(line, line + samples, Complex{});
        continue;
      }
      if (x.correction) {
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
        Complex* slice = field + j * vertices;
        for (Index i = 0; i < own; ++i) {
          slice[vertex_[first + i]] = scratch.x[static_cast<std::size_t>(i) * samples + j];
        }
      }
    }
    for (Index i = 0; i < own; ++i) {
      const Index row = first + i;
      const Complex* line = scratch.x.data() + static_cast<std::size_t>(i) * samples;
      std::fill(scratch.real.begin(), scratch.real.end(), 0.0);
      std::fill(scratch.imaginary.begin(), scratch.imaginary.end(), 0.0);
      double* r = scratch.real.data();
      if (!zero && active[row]) {
        const double k = lambdaCoupling_ * matrix.mass[row];
        for (std::size_t e = matrix.start[row]; e < matrix.start[row + 1]; ++e) {
          addCoupling(matrix.value[e], scratch.x.data() + static_cast<std::size_t>(localColumn_[e]) * samples, samples,
                      r, scratch.imaginary.data());
        }
        const double* v = reinterpret_cast<const double*>(line);
        const double diagonal = matrix.diagonal[row];
        for (Index j = 0; j < samples; ++j) {
          r[2 * j] += diagonal * v[2 * j] - scratch.imaginary[2 * j + 1];
          r[2 * j + 1] += diagonal * v[2 * j + 1] + scratch.imaginary[2 * j];
        }
        for (Index t = 0; t + 2 < 2 * samples; ++t) {
          const double flow = k * (v[t + 2] - v[t]);
          r[t] -= flow;
          r[t + 2] += flow;
        }
      }
      for (Index t = 0; t < 2 * samples; ++t) r[t] = -r[t];
      for (const auto* e = constraints.begin(row); e != constraints.end(row); ++e) {
        const Complex pull = e->hard() ? Complex{} : e->pull - e->weight * line[e->sample];
        r[2 * e->sample] = e->hard() ? 0.0 : r[2 * e->sample] + pull.real();
        r[2 * e->sample + 1] = e->hard() ? 0.0 : r[2 * e->sample + 1] + pull.imag();
      }
      squares[chunk] += std::inner_product(r, r + 2 * samples, r, 0.0);
      if (residual) {
        float* out = residual + row * stride;
        std::transform(r, r + 2 * samples, out, [&](double value) { return static_cast<float>(value / residualScale); });
        std::fill(out + 2 * samples, out + stride, 0.0f);
      }
    }
  });
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0));
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
