#include "solver/space_time_operator.h"

#include "solver/chunk_loop.h"
#include "solver/row_algebra.h"
#include "solver/row_sums.h"

namespace stormfield {

void SpaceTimeOperator::image(Index row, const float* x, float* out) const {
  const std::size_t stride = level_.lambda.stride();
  const Index last = 2 * level_.lambda.samples() - 2;
  const float* own = x + row * stride;
  const float k = level_.lambdaCoupling[row];
  const float diagonal = level_.diagonal[row] + 2.0f * k;
  kernels::prefetchAhead(x, row, level_.rows(), stride, 1);
  kernels::rowSums().image(level_.couplings.begin(row), level_.couplings.end(row), x, stride, diagonal, own, out);
  for (Index t = 2; t < last; ++t) out[t] -= k * (own[t - 2] + own[t + 2]);
  // The first and last sample have one neighbour, an only one none.
  for (Index t = 0; t < 2; ++t) {
    if (last == 0) {
      out[t] -= 2.0f * k * own[t];
    } else {
      out[t] -= k * (own[t] + own[t + 2]);
      out[last + t] -= k * (own[last + t] + own[last + t - 2]);
    }
  }
  for (const auto* e = constraints_.begin(row); e != constraints_.end(row); ++e) {
    for (Index t = 2 * e->sample; t < 2 * e->sample + 2; ++t) {
      out[t] = e->hard() ? 0.0f : out[t] + static_cast<float>(e->weight) * own[t];
    }
  }
}

SpaceTimeOperator::Products SpaceTimeOperator::apply(const float* p, float* q, const float* r,
                                                     const Progress& progress) const {
  const std::size_t stride = level_.lambda.stride();
  std::vector<Products> parts(level_.sweep.chunks());
  forAllChunks(level_, progress, [&](Index chunk) {
    Products part;
    for (Index i = level_.sweep.chunkStart[chunk]; i < level_.sweep.chunkStart[chunk + 1]; ++i) {
      float* out = q + i * stride;
      image(i, p, out);
      const float *step = p + i * stride, *residual = r + i * stride;
      part.residualStep += kernels::dotRow(residual, step, stride);
      part.stepImage += kernels::dotRow(step, out, stride);
      part.residualImage += kernels::dotRow(residual, out, stride);
      part.imageImage += kernels::dotRow(out, out, stride);
      part.stepStep += mass_[i] * kernels::dotRow(step, step, stride);
    }
    parts[chunk] = part;
  });
  Products sum;
  for (const Products& part : parts) {
    sum.residualStep += part.residualStep;
    sum.stepImage += part.stepImage;
    sum.residualImage += part.residualImage;
    sum.imageImage += part.imageImage;
    sum.stepStep += part.stepStep;
  }
  return sum;
}

std::vector<double> SpaceTimeOperator::residual(const float* x, double scale, float* r, const ConstraintRows* before,
                                                const Progress& progress) const {
  const std::size_t stride = level_.lambda.stride();
  std::vector<double> squares(level_.sweep.chunks(), 0.0);
  forAllChunks(level_, progress, [&](Index chunk) {
    for (Index i = level_.sweep.chunkStart[chunk]; i < level_.sweep.chunkStart[chunk + 1]; ++i) {
      float* out = r + i * stride;
      if (!before || !constraints_.sameRow(i, *before)) {
        image(i, x, out);
        for (std::size_t k = 0; k < stride; k += 4) kernels::store(out + k, -kernels::load(out + k));
        for (const auto* e = constraints_.begin(i); e != constraints_.end(i); ++e) {
          if (e->hard()) continue;
          out[2 * e->sample] += static_cast<float>(e->pull.real() / scale);
          out[2 * e->sample + 1] += static_cast<float>(e->pull.imag() / scale);
        }
      }
      squares[chunk] += kernels::dotRow(out, out, stride);
    }
  });
  return squares;
}

}  // namespace stormfield
