// Rotation of a vector field: n . (curl V) at every vertex, twice the angular speed of the surface there in radians per
// second, positive counter-clockwise seen from outside. Materials find storms by it: it is large in their cores, and
// has the other sign in the collar around them.
//
// By Stokes' theorem the mean over a face is the circulation around it over its area; a vertex has the mean of its
// faces, weighted by area.
//
//   std::vector<double> curl(mesh.vertexCount());
//   rotation(mesh, vectors, curl.data());
#pragma once

#include "mesh/triangle_mesh.h"

namespace stormfield {

/// One value per vertex from tangent vectors in space, mesh units per second; 0 at vertices that no face uses.
void rotation(const TriangleMesh& mesh, const Points& vectors, double* result);

}  // namespace stormfield
