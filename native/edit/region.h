// Regions of faces that a user chooses: a disc around a point, or what a loop encloses.
//
//   const std::vector<Index> disc = facesInDisc(mesh, seed, 0.2);
#pragma once

#include <vector>

#include "mesh/closest_point.h"

namespace stormfield {

/// The faces whose corners all lie within this distance of the point (in a straight line), as far as they hang together
/// with its face by edges; ascending.
std::vector<Index> facesInDisc(const TriangleMesh& mesh, const SurfacePoint& center, double radius);

/// The faces that a closed curve crosses, and those that it cuts off from the largest rest of its component; ascending.
/// query: of the mesh; points: in space, near the surface, the curve is straight in between. Throws InputError for fewer than three points.
std::vector<Index> facesInLoop(const TriangleMesh& mesh, const ClosestPointQuery& query,
                               const std::vector<Vec3>& points);

}  // namespace stormfield
