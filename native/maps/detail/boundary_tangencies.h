// Where the flow tears the surface apart: along trajectories that touch the boundary from inside. On one side of such a
// trajectory points leave, on the other they pass and go on, so that the image of a face may be bounded by the way on
// from where it touches, and by the boundary, alone: no point of the face's own edges needs to stay.
#pragma once

#include <utility>
#include <vector>

#include "maps/point_advector.h"

namespace stormfield {

/// Faces that are torn, each with those that the edge of the tear is in after tau: pairs, ascending, each once. Touched
/// is the boundary where the field, which is linear along an edge, turns from outwards to inwards or back.
std::vector<std::pair<Index, Index>> boundaryTangencyEdges(const PreparedFlow& flow, double tau,
                                                           const Progress* progress);

}  // namespace stormfield
