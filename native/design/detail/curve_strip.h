// The strip around a drawn curve: the vertices closer than its half width, reached from the curve along the surface,
// with the curve's direction carried to each (thesis 5.2.2, 11.1.2).
#pragma once

#include <vector>

#include "design/detail/surface_path.h"
#include "mesh/vertex_charts.h"

namespace stormfield {

struct StripEntry {
  Index vertex = kNone;
  double distance = 0.0;  ///< from the closest point of the curve, mesh units
  double offset = 0.0;    ///< the part of it across the curve: positive to the left, seen from outside
  Complex direction;      ///< unit tangent of the curve there, in the chart of the vertex
  bool onCurve = false;   ///< corner of a face the curve runs through
};

/// By vertex. The corners of the faces the curve runs through are always there, however narrow the strip.
std::vector<StripEntry> curveStrip(const VertexCharts& charts, const SurfacePath& path, double halfWidth);

}  // namespace stormfield
