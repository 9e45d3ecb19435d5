// A tangent vector field: one vector per vertex, continuous in between (thesis 2.5).
#pragma once

#include <memory>
#include <vector>

#include "mesh/surface_point.h"
#include "mesh/vertex_charts.h"

namespace stormfield {

/// values[v] is the vector at vertex v in its polar chart, mesh units per second.
struct VectorField {
  std::shared_ptr<const VertexCharts> charts;
  std::vector<Complex> values;

  const TriangleMesh& mesh() const { return charts->mesh(); }
};

/// Throws InputError on a size that does not match the mesh or a value that is not finite (names the vertex).
VectorField makeVectorField(std::shared_ptr<const VertexCharts> charts, std::vector<Complex> values);
/// From vectors in space (n x 3); their normal components are dropped.
VectorField fromSpace(std::shared_ptr<const VertexCharts> charts, const Points& vectors);
/// To vectors in space (n x 3).
Points toSpace(const VectorField& field);

}  // namespace stormfield
