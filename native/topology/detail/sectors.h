// The angular sectors that faces make around a point of the surface, in the flat frames of the faces.
#pragma once

#include <vector>

#include "mesh/surface_point.h"
#include "mesh/vertex_charts.h"

namespace stormfield {

struct Sector {
  Index face = kNone;
  Complex apex;          ///< the point, in the face's flat frame
  double from = 0.0;     ///< first direction, radians in the flat frame, counter-clockwise from there
  double opening = 0.0;  ///< radians
};

/// Counter-clockwise: one sector inside a face, two on an edge, a fan at a vertex. A point nearer than 1e-6
/// (barycentric) to an edge or a vertex is on it.
std::vector<Sector> sectorsAround(const VertexCharts& charts, const SurfacePoint& p);

/// Whether the last sector is followed by the first: everywhere but on the boundary.
bool surroundsPoint(const VertexCharts& charts, const SurfacePoint& p, const std::vector<Sector>& sectors);

}  // namespace stormfield
