#include "solver/lambda_grid.h"

namespace stormfield {

LambdaGrid finestLambdaGrid(Index samples) {
  return {std::vector<float>(samples, 1.0f), 1.0f};
}

LambdaGrid coarsened(const LambdaGrid& fine) {
  const Index n = fine.samples();
  const Index coarse = (n + 1) / 2;
  // Two fine couplings meet the halved difference each: 2 * (1/2)^2.
  LambdaGrid result{std::vector<float>(coarse, 0.0f), 0.5f * fine.coupling};
  for (Index j = 0; j < n; ++j) {
    if (j % 2 == 0) {
      result.mass[j / 2] += fine.mass[j];
    } else if (j + 1 == n) {
      result.mass[j / 2] += fine.mass[j];
    } else {
      result.mass[j / 2] += 0.5f * fine.mass[j];
      result.mass[j / 2 + 1] += 0.5f * fine.mass[j];
    }
  }
  return result;
}

void restrictLambda(const float* fine, Index fineSamples, float* coarse) {
  const Index pairs = (fineSamples - 1) / 2;
  for (Index k = 0; k < 2; ++k) coarse[k] = fine[k];
  for (Index c = 0; c < pairs; ++c) {
    for (Index k = 0; k < 2; ++k) {
      const float half = 0.5f * fine[4 * c + 2 + k];
      coarse[2 * c + k] += half;
      coarse[2 * c + 2 + k] = fine[4 * c + 4 + k] + half;
    }
  }
  if (fineSamples % 2 == 0) {
    for (Index k = 0; k < 2; ++k) coarse[2 * pairs + k] += fine[4 * pairs + 2 + k];
  }
}

void addProlongedLambda(const float* coarse, Index fineSamples, float* fine) {
  const Index pairs = (fineSamples - 1) / 2;
  for (Index c = 0; c < pairs; ++c) {
    for (Index k = 0; k < 2; ++k) {
      fine[4 * c + k] += coarse[2 * c + k];
      fine[4 * c + 2 + k] += 0.5f * (coarse[2 * c + k] + coarse[2 * c + 2 + k]);
    }
  }
  for (Index k = 0; k < 2; ++k) {
    fine[4 * pairs + k] += coarse[2 * pairs + k];
    if (fineSamples % 2 == 0) fine[4 * pairs + 2 + k] += coarse[2 * pairs + k];
  }
}

}  // namespace stormfield
