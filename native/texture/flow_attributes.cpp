#include "texture/flow_attributes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "texture/rotation.h"

namespace stormfield {
namespace {

Points sampleInSpace(const ParameterizedField& field, Index sample) {
  const Complex* values = field.sample(sample);
  Points vectors(field.vertexCount(), 3);
  for (Index v = 0; v < field.vertexCount(); ++v) vectors.row(v) = field.charts->toSpace(v, values[v]);
  return vectors;
}

void write(const double* values, std::size_t count, float* to) {
  std::transform(values, values + count, to, [](double value) { return static_cast<float>(value); });
}

}  // namespace

FlowAttributes flowAttributes(const ParameterizedField& field, Index first, Index count,
                              const StreamFunctionSolver& streams, Progress* progress) {
  constexpr Index kTogether = StreamFunctionSolver::kTogether;
  const std::size_t n = field.vertexCount(), all = n * count;
  FlowAttributes result{std::vector<float>(3 * all), std::vector<float>(all), std::vector<float>(all),
                        std::vector<float>(all)};
  std::atomic<Index> done{0};
  tbb::parallel_for(Index{0}, (count + kTogether - 1) / kTogether, [&](Index block) {
    const Index begin = block * kTogether, end = std::min(begin + kTogether, count);
    if (progress != nullptr) progress->check();
    const std::vector<double> psi = streams.solve(field.sample(first + begin), end - begin);
    write(psi.data(), psi.size(), result.stream.data() + n * begin);
    std::vector<double> curl(n);
    for (Index j = begin; j < end; ++j) {
      if (progress != nullptr) progress->check();
      const Points vectors = sampleInSpace(field, first + j);
      rotation(field.charts->mesh(), vectors, curl.data());
      write(vectors.data(), 3 * n, result.vectors.data() + 3 * n * j);
      write(curl.data(), n, result.rotation.data() + n * j);
      for (std::size_t v = 0; v < n; ++v) {
        result.speed[n * j + v] = static_cast<float>(vectors.row(static_cast<Eigen::Index>(v)).norm());
      }
    }
    if (progress != nullptr) progress->report(static_cast<double>(done += end - begin) / count);
  });
  return result;
}

std::vector<float> vectorsInSpace(const ParameterizedField& field, Index first, Index count, Progress* progress) {
  const std::size_t n = field.vertexCount();
  std::vector<float> result(3 * n * count);
  tbb::parallel_for(Index{0}, count, [&](Index j) {
    if (progress != nullptr) progress->check();
    const Points vectors = sampleInSpace(field, first + j);
    write(vectors.data(), 3 * n, result.data() + 3 * n * j);
  });
  return result;
}

}  // namespace stormfield
