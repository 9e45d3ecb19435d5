// Fields over lambda with known paths and bifurcations.
#pragma once

#include <functional>

#include "field/parameterized_field.h"
#include "fixtures.h"

namespace stormfield::test {

using SpaceField = std::function<Vec3(const Vec3& point, double lambda)>;

inline std::vector<double> evenLambdas(int samples) {
  std::vector<double> lambdas(samples);
  for (int j = 0; j < samples; ++j) lambdas[j] = samples > 1 ? static_cast<double>(j) / (samples - 1) : 0.0;
  return lambdas;
}

inline ParameterizedField parameterized(const std::shared_ptr<const VertexCharts>& charts, std::vector<double> lambdas,
                                        const SpaceField& function) {
  const TriangleMesh& mesh = charts->mesh();
  std::vector<Complex> values;
  for (const double lambda : lambdas) {
    Points vectors(mesh.vertexCount(), 3);
    for (Index v = 0; v < mesh.vertexCount(); ++v) vectors.row(v) = function(mesh.point(v), lambda);
    const std::vector<Complex> sample = fromSpace(charts, vectors).values;
    values.insert(values.end(), sample.begin(), sample.end());
  }
  return makeParameterizedField(charts, std::move(lambdas), std::move(values));
}

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
  return parameterized(charts, evenLambdas(samples), [&](const Vec3& p, double l) -> Vec3 {
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

/// The plane's normal forms, moved to a place, turned and scaled.
struct Placement {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double angle = 0.0;
  double size = 1.0;                                ///< mesh units per unit of the normal form
  double lambda = 0.5;                              ///< of the bifurcation
  double rate = 1.0;                                ///< of the normal form's parameter per lambda
  Eigen::Vector2d drift = Eigen::Vector2d::Zero();  ///< of the whole pattern per lambda

  /// form(x, y, parameter) in the normal form's own coordinates.
  SpaceField field(const std::function<Eigen::Vector2d(double, double, double)>& form) const {
    return [*this, form](const Vec3& p, double l) -> Vec3 {
      const Eigen::Rotation2Dd turn(angle);
      const Eigen::Vector2d local = turn.inverse() * (p.head<2>() - place - (l - lambda) * drift) / size;
      const Eigen::Vector2d v = turn * form(local.x(), local.y(), rate * (l - lambda));
      return {v.x(), v.y(), 0.0};
    };
  }
};

}  // namespace stormfield::test
