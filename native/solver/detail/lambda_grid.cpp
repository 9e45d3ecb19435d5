#include "solver/detail/lambda_grid.h"

#include "solver/detail/line_kernels.h"

namespace stormfield {

using kernels::load;
using kernels::shuffled;
using kernels::store;
using kernels::Vector;

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
  const Index samples = (fineSamples + 1) / 2;
  Vector before = {};  // the samples between those of the vector before
  for (Index c = 0; c < samples; c += 2) {
    const Vector first = load(fine + 4 * c), second = load(fine + 4 * c + 4);
    const Vector kept = shuffled<0, 1, 4, 5>(first, second);
    const Vector between = shuffled<2, 3, 6, 7>(first, second);
    store(coarse + 2 * c, kept + 0.5f * (shuffled<2, 3, 4, 5>(before, between) + between));
    before = between;
  }
  for (Index k = 0; k < 2; ++k) {
    if (fineSamples % 2 == 0) coarse[2 * samples - 2 + k] += 0.5f * fine[2 * fineSamples - 2 + k];
    if (samples % 2 == 1) coarse[2 * samples + k] = 0.0f;
  }
}

void addProlongedLambda(const float* coarse, Index fineSamples, float* fine) {
  const Index samples = (fineSamples + 1) / 2;
  Vector next = load(coarse);
  for (Index c = 0; c < samples; c += 2) {
    const Vector kept = next;
    next = c + 2 < samples ? load(coarse + 2 * c + 4) : Vector{};
    const Vector between = 0.5f * (kept + shuffled<2, 3, 4, 5>(kept, next));
    store(fine + 4 * c, load(fine + 4 * c) + shuffled<0, 1, 4, 5>(kept, between));
    store(fine + 4 * c + 4, load(fine + 4 * c + 4) + shuffled<2, 3, 6, 7>(kept, between));
  }
  for (Index k = 0; k < 2; ++k) {
    if (fineSamples % 2 == 0) {
      fine[2 * fineSamples - 2 + k] += 0.5f * coarse[2 * samples - 2 + k];
    } else {
      fine[2 * fineSamples + k] = 0.0f;
    }
  }
}

}  // namespace stormfield
