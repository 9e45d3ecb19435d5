// Straight on over the surface: the straightest path from a point, unfolded face by face.
#pragma once

#include "tracing/flat_faces.h"

namespace stormfield {

struct SurfaceWalk {
  SurfacePoint point;
  Complex direction;    ///< unit, the way on, in the flat frame of point.face
  double length = 0.0;  ///< shorter than asked where the boundary ends the way
};

/// direction: in the flat frame of from.face, any length but 0. length: mesh units. A path that meets a vertex passes
/// beside it.
SurfaceWalk walkStraight(const FlatFaces& faces, const SurfacePoint& from, Complex direction, double length);

}  // namespace stormfield
