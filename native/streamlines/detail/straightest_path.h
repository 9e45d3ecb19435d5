// The straightest path from a point of the surface in a direction: straight within each face, and straight over each
// edge once its two faces are unfolded (Polthier and Schmies 1998).
//
//   const StraightestPath path = straightestPath(faces, from, Complex(1.0, 0.0), length);
#pragma once

#include "tracing/flat_faces.h"

namespace stormfield {

struct StraightestPath {
  SurfacePoint point;   ///< its end
  Complex direction;    ///< unit, of the path at its end, in the flat frame of point.face
  double length = 0.0;  ///< mesh units; shorter than asked where the path ends at the boundary
};

/// direction: in the flat frame of from.face, any length but 0. length: mesh units. A path that meets a vertex passes
/// it at 1e-9 of an edge.
StraightestPath straightestPath(const FlatFaces& faces, const SurfacePoint& from, Complex direction, double length);

}  // namespace stormfield
