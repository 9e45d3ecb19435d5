#include "field/vector_field.h"

#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

VectorField makeVectorField(std::shared_ptr<const VertexCharts> charts, std::vector<Complex> values) {
  const auto expected = static_cast<std::size_t>(charts->mesh().vertexCount());
  if (values.size() != expected) {
    throw InputError(message("the field has ", values.size(), " vectors, but the mesh has ", expected,
                             " vertices; give one vector per vertex"));
  }
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (!std::isfinite(values[v].real()) || !std::isfinite(values[v].imag())) {
      throw InputError(message("the vector at vertex ", v, " is not finite; give it real components"));
    }
  }
  return {std::move(charts), std::move(values)};
}

VectorField fromSpace(std::shared_ptr<const VertexCharts> charts, const Points& vectors) {
  std::vector<Complex> values(static_cast<std::size_t>(vectors.rows()));
  if (vectors.rows() == charts->mesh().vertexCount()) {
    for (Index v = 0; v < vectors.rows(); ++v) values[v] = charts->toTangent(v, vectors.row(v));
  }
  return makeVectorField(std::move(charts), std::move(values));
}

Points toSpace(const VectorField& field) {
  Points vectors(field.mesh().vertexCount(), 3);
  for (Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = field.charts->toSpace(v, field.values[v]);
  return vectors;
}

}  // namespace stormfield
