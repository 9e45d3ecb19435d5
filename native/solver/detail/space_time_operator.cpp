#include "solver/detail/space_time_operator.h"

#include <algorithm>

#include "solver/detail/chunk_loop.h"
#include "solver/detail/row_algebra.h"
#include "solver/detail/row_sums.h"

namespace stormfield {

void SpaceTimeOperator::image(Index row, const float* x, float* line, float* out) const {
  const std::size_t stride = level_.lambda.stride(), end = 2 * static_cast<std::size_t>(level_.lambda.samples());
  const float k = level_.lambdaCoupling[row];
  const float diagonal = level_.diagonal[row] + 2.0f * k;
  kernels::prefetchAhead(x, row, level_.rows(), stride, 1);
  // Beyond the first and the last sample their own values: the ends of lambda are natural.
  float* own = line + 2;
  std::copy_n(x + row * stride, stride, own);
  std::copy_n(own, 2, line);
  std::copy_n(own + end - 2, 2, own + end);
  kernels::rowSums().image(level_.couplings.begin(row), level_.couplings.end(row), x, stride, diagonal, k, own, out);
  std::fill(out + end, out + stride, 0.0f);
  for (const auto* e = constraints_.begin(row); e != constraints_.end(row); ++e) {
    for (Index t = 2 * e->sample; t < 2 * e->sample + 2; ++t) {
      out[t] = e->hard() ? 0.0f : out[t] + static_cast<float>(e->weight) * own[t];
    }
  }
}

SpaceTimeOperator::Products SpaceTimeOperator::apply(const float* p, float* q, const float* r,
                                                     const Progress& progress) const {
  const std::size_t stride = level_.lambda.stride();
  std::vector<Products> sums(level_.sweep.chunks());
  forAllChunks(level_, progress, [&](Index chunk) {
    double sum[5] = {}, own[5];
    std::vector<float> line(stride + 4);
    for (Index i = level_.sweep.chunkStart[chunk]; i < level_.sweep.chunkStart[chunk + 1]; ++i) {
      float* out = q + i * stride;
      image(i, p, line.data(), out);
      kernels::rowSums().products(p + i * stride, out, r + i * stride, stride, own);
      own[4] *= mass_[i];
      for (int k = 0; k < 5; ++k) sum[k] += own[k];
    }
    sums[chunk] = {sum[0], sum[1], sum[2], sum[3], sum[4]};
  });
  Products total;
  for (const Products& sum : sums) {
    total.residualStep += sum.residualStep;
    total.stepImage += sum.stepImage;
    total.residualImage += sum.residualImage;
    total.imageImage += sum.imageImage;
    total.stepStep += sum.stepStep;
  }
  return total;
}

std::vector<double> SpaceTimeOperator::residual(const float* x, double scale, float* r, const ConstraintRows* before,
                                                const Progress& progress) const {
  const std::size_t stride = level_.lambda.stride();
  std::vector<double> squares(level_.sweep.chunks(), 0.0);
  forAllChunks(level_, progress, [&](Index chunk) {
    std::vector<float> line(stride + 4);
    for (Index i = level_.sweep.chunkStart[chunk]; i < level_.sweep.chunkStart[chunk + 1]; ++i) {
      float* out = r + i * stride;
      if (!before || !constraints_.sameRow(i, *before)) {
        image(i, x, line.data(), out);
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
