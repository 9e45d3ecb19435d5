// Poincare index of every face, an integer from edge data only (thesis 2.2.3; docs/architecture.md, decision 2).
//
// Along an edge the field rotates by the wrapped angle between its two carried end vectors, computed once per edge; at
// the corners it rotates by the chart's own twist. The rotations around a face add up to 2 pi times an integer, and
// over a closed mesh these integers add up to the Euler characteristic exactly, whatever the values.
//
//   const std::vector<int> indices = poincareIndices(field);  // 1 at sources, sinks and centers, -1 at saddles
#pragma once

#include <vector>

#include "field/vector_field.h"

namespace stormfield {

/// Rotation of the field along halfedge edgeHalfedge(e), radians in (-pi, pi]. Opposed end vectors rotate by +pi along
/// the canonical halfedge; a zero vector counts as an infinitesimal one along its chart's x axis. Both rules are
/// deterministic, so that zeros on edges and at vertices belong to one face only.
std::vector<double> edgeRotations(const VertexCharts& charts, const Complex* values);
/// One index per face.
std::vector<int> poincareIndices(const VertexCharts& charts, const Complex* values);
std::vector<int> poincareIndices(const VectorField& field);
/// Of one face.
int poincareIndex(const VectorField& field, Index face);

}  // namespace stormfield
