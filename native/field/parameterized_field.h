// A field for every lambda in [0, 1]: samples at lambda_j, linear between (thesis 10.2, 11.1.1).
#pragma once

#include "field/field_values.h"
#include "field/vector_field.h"

namespace stormfield {

/// Samples that lie evenly, lambda_j = j / (samples - 1); a single one lies at 0.
std::vector<double> evenLambdas(Index samples);

/// lambdas strictly increasing in [0, 1], at least one; values[j * vertexCount + v] in the chart of v.
struct ParameterizedField {
  std::shared_ptr<const VertexCharts> charts;
  std::vector<double> lambdas;
  FieldValues values;

  Index sampleCount() const { return static_cast<Index>(lambdas.size()); }
  Index vertexCount() const { return charts->mesh().vertexCount(); }
  const Complex* sample(Index j) const { return values.data() + static_cast<std::size_t>(j) * vertexCount(); }
};

/// Throws InputError on sizes that do not match, lambdas outside 0..1 or not increasing, values that are not finite.
ParameterizedField makeParameterizedField(std::shared_ptr<const VertexCharts> charts, std::vector<double> lambdas,
                                          FieldValues values);
/// The instantaneous field at lambda (clamped to the first and last sample).
VectorField at(const ParameterizedField& field, double lambda);
/// Sample j as a field of its own.
VectorField sampleField(const ParameterizedField& field, Index j);

}  // namespace stormfield
