// The directions in which trajectories leave and enter a fixed point of negative index: the borders of its hyperbolic
// sectors (thesis 2.2.1; Helman and Hesselink 1989; Andronov et al. 1973 for degenerate points).
#pragma once

#include <vector>

#include "field/vector_field.h"
#include "topology/entities.h"
#include "tracing/flat_faces.h"

namespace stormfield {

/// Directions along which the field points straight away from the point or towards it, where one kind follows the
/// other; counter-clockwise. Needs no Jacobian, so that points at vertices and on edges are treated alike.
std::vector<SeparatrixDirection> separatrixDirections(const VectorField& field, const SurfacePoint& p);

/// Where the trace of a separatrix begins: a thousandth of the face from the fixed point p, inside the face of its
/// direction.
SurfacePoint separatrixStart(const FlatFaces& faces, const SurfacePoint& p, const SeparatrixDirection& direction);

}  // namespace stormfield
