// Vertices along a Morton curve: near each other in the list means near each other on the surface, whatever the order in
// which the mesh came. Work that goes through them in this order finds what it reads in the cache.
#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"

namespace stormfield {

/// Those that a face uses.
std::vector<Index> mortonOrder(const TriangleMesh& mesh);

}  // namespace stormfield
