// The directions in which trajectories leave and enter a fixed point of negative index.
#pragma once

#include "topology/fixed_points.h"

namespace stormfield {

/// A sector of the surface around a point: the part of one face between two directions.
struct Sector {
  Index face = kNone;
  Complex apex;          ///< the point, in the face's flat frame
  double from = 0.0;     ///< first direction, radians in the flat frame, counter-clockwise from there
  double opening = 0.0;  ///< radians
};
/// The sectors around a point, counter-clockwise: one inside a face, two on an edge, a fan at a vertex (within 1e-6,
/// barycentric).
std::vector<Sector> sectorsAround(const VertexCharts& charts, const SurfacePoint& p);

/// Directions along which the field points straight away from or to the point, where one kind follows the other: the
/// borders of hyperbolic sectors. Needs no Jacobian, so that points at vertices and on edges are treated alike.
std::vector<SeparatrixDirection> separatrixDirections(const VectorField& field, const SurfacePoint& p);

}  // namespace stormfield
