#include "field/parameterized_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

std::vector<double> evenLambdas(Index samples) {
  std::vector<double> lambdas(samples, 0.0);
  for (Index j = 1; j < samples; ++j) lambdas[j] = static_cast<double>(j) / (samples - 1);
  return lambdas;
}

ParameterizedField makeParameterizedField(std::shared_ptr<const VertexCharts> charts, std::vector<double> lambdas,
                                          FieldValues values) {
  if (lambdas.empty()) throw InputError("the field has no samples; give at least one lambda");
  for (std::size_t j = 0; j < lambdas.size(); ++j) {
    // Written so that a NaN fails as well.
    if (!(lambdas[j] >= 0.0 && lambdas[j] <= 1.0)) {
      throw InputError(message("lambda of sample ", j, " is ", lambdas[j], "; keep it between 0 and 1"));
    }
    if (j > 0 && !(lambdas[j] > lambdas[j - 1])) {
      throw InputError(message("lambda of sample ", j, " (", lambdas[j], ") does not exceed the one before it (",
                               lambdas[j - 1], "); sort the samples and drop repeated ones"));
    }
  }
  const auto n = static_cast<std::size_t>(charts->mesh().vertexCount());
  if (values.size() != n * lambdas.size()) {
    throw InputError(message("the field has ", values.size(), " vectors, but ", lambdas.size(), " samples on ", n,
                             " vertices need ", n * lambdas.size(), "; give one vector per sample and vertex"));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i].real()) || !std::isfinite(values[i].imag())) {
      throw InputError(
          message("the vector at vertex ", i % n, " of sample ", i / n, " is not finite; give it real components"));
    }
  }
  return {std::move(charts), std::move(lambdas), std::move(values)};
}

VectorField at(const ParameterizedField& field, double lambda) {
  if (!std::isfinite(lambda)) throw InputError("lambda is not finite; keep it between 0 and 1");
  const auto above = std::upper_bound(field.lambdas.begin(), field.lambdas.end(), lambda);
  if (above == field.lambdas.begin()) return sampleField(field, 0);
  if (above == field.lambdas.end()) return sampleField(field, field.sampleCount() - 1);
  const auto j = static_cast<Index>(above - field.lambdas.begin()) - 1;
  const double t = (lambda - field.lambdas[j]) / (field.lambdas[j + 1] - field.lambdas[j]);
  const Complex *from = field.sample(j), *to = field.sample(j + 1);
  VectorField result{field.charts, std::vector<Complex>(field.vertexCount())};
  for (Index v = 0; v < field.vertexCount(); ++v) result.values[v] = (1.0 - t) * from[v] + t * to[v];
  return result;
}

VectorField sampleField(const ParameterizedField& field, Index j) {
  if (j < 0 || j >= field.sampleCount()) {
    throw InputError(message("sample ", j, " does not exist; the field has samples 0 to ", field.sampleCount() - 1));
  }
  return {field.charts, std::vector<Complex>(field.sample(j), field.sample(j) + field.vertexCount())};
}

}  // namespace stormfield
