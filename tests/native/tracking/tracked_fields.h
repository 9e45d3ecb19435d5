// Fields over lambda with known paths and bifurcations.
#pragma once

#include <functional>

#include "field/analytic_fields.h"
#include "fixtures.h"

namespace stormfield::test {

/// Independent random fields at each sample: the roughest there is.
inline ParameterizedField randomHistory(const std::shared_ptr<const VertexCharts>& charts, int samples,
                                        std::uint64_t seed) {
  std::vector<Complex> values;
  for (int j = 0; j < samples; ++j) {
    const auto sample = randomField(charts, seed + 1000 * j).values;
    values.insert(values.end(), sample.begin(), sample.end());
  }
  return makeParameterizedField(charts, evenLambdas(samples), values);
}

inline ParameterizedField randomIntegerHistory(const std::shared_ptr<const VertexCharts>& charts, int samples,
                                               std::uint64_t seed) {
  std::vector<Complex> values;
  for (int j = 0; j < samples; ++j) {
    const auto sample = randomIntegerField(charts, seed + 1000 * j).values;
    values.insert(values.end(), sample.begin(), sample.end());
  }
  return makeParameterizedField(charts, evenLambdas(samples), values);
}

/// A random quadratic map of space.
inline std::function<Vec3(const Vec3&)> smoothMap(std::uint64_t seed) {
  Random random(seed);
  Eigen::Matrix<double, 3, 10> coefficients;
  for (Eigen::Index i = 0; i < coefficients.size(); ++i) coefficients.data()[i] = random.uniform();
  return [coefficients](const Vec3& p) -> Vec3 {
    Eigen::Matrix<double, 10, 1> terms;
    terms << 1.0, p, p.cwiseProduct(p), p.x() * p.y(), p.y() * p.z(), p.z() * p.x();
    return coefficients * terms;
  };
}

/// One random smooth field blended into another, not linearly.
inline ParameterizedField smoothBlend(const std::shared_ptr<const VertexCharts>& charts, int samples,
                                      std::uint64_t seed) {
  const auto from = smoothMap(seed), to = smoothMap(seed + 500), between = smoothMap(seed + 900);
  return sampled(charts, evenLambdas(samples), [&](const Vec3& p, double l) -> Vec3 {
    return (1.0 - l) * from(p) + l * to(p) + 2.0 * l * (1.0 - l) * between(p);
  });
}

inline ParameterizedField reversedInLambda(const ParameterizedField& field) {
  ParameterizedField result = field;
  const Index s = field.sampleCount();
  for (Index j = 0; j < s; ++j) {
    result.lambdas[j] = 1.0 - field.lambdas[s - 1 - j];
    std::copy_n(field.sample(s - 1 - j), field.vertexCount(),
                result.values.begin() + static_cast<std::ptrdiff_t>(j) * field.vertexCount());
  }
  return result;
}

}  // namespace stormfield::test
