// Boundary tangencies: trajectories that touch the boundary of the surface from inside (thesis 2.4; internal tangencies
// in the boundary graph of topology/).
//
// On one side of such a trajectory points leave the surface, on the other they pass and continue. The flow map is
// discontinuous across it: the image of a face may be bounded by the continuation of the tangent trajectory and by the
// boundary of the surface alone, so that no image of the face's own edges shows it.
#pragma once

#include <compare>
#include <vector>

#include "base/types.h"
#include "maps/prepared_flow.h"

namespace stormfield {

/// An edge of F that a tangent trajectory shows: a face that it passes, and the face where it is tau later.
struct TangencyEdge {
  Index face, image;

  auto operator<=>(const TangencyEdge&) const = default;
};

/// The edges of all boundary tangencies, ascending, each once. A tangency is where the field's component across the
/// boundary, which is linear along an edge, changes its sign: inside an edge or at a vertex. Throws Cancelled.
std::vector<TangencyEdge> boundaryTangencyEdges(const PreparedFlow& flow, double tau, const Progress* progress);

}  // namespace stormfield
