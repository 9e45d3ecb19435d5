// A drawn loop that becomes a periodic orbit must be one that the mesh can hold.
#pragma once

#include "design/detail/surface_path.h"

namespace stormfield {

/// Throws InputError naming the element where the loop is smaller than an edge, jumps to another part of the surface,
/// crosses itself, or comes back to itself closer than an edge.
void checkLoop(const TriangleMesh& mesh, const SurfacePath& path, const DesignElement& element);

}  // namespace stormfield
