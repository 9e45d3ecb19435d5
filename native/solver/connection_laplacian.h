// The connection Laplacian of tangent vectors on a surface (thesis eq. 4.1, 11.2, carried to tangent planes; Sharp,
// Soliman, Crane 2019, The Vector Heat Method).
//
// Energy: sum over edges of w_e |V_head - transport V_tail|^2, with the cotangent weights w_e = (cot a + cot b) / 2 of
// the angles opposite to e (one angle at a boundary: the boundary is natural). Weights below zero (an edge that is not
// Delaunay) are set to zero: the matrix is then Hermitian with positive weights, as a mean value needs, and stays
// connected, because such an edge is the longest of a triangle whose other two edges join the same vertices. Thesis eq.
// 4.1 takes Floater's mean value weights instead; they are positive too, but not symmetric.
//
// In a flat square grid the weights are those of the five-point stencil.
#pragma once

#include "mesh/vertex_charts.h"
#include "solver/surface_matrix.h"

namespace stormfield {

struct ConnectionLaplacian {
  SurfaceMatrix matrix;
  /// Mesh vertex of each row, along a space-filling curve so that neighbours are close in memory. Unused vertices have
  /// no row.
  std::vector<Index> vertex;
};

ConnectionLaplacian connectionLaplacian(const VertexCharts& charts);
/// w_e above, >= 0.
double edgeWeight(const TriangleMesh& mesh, Index e);

}  // namespace stormfield
