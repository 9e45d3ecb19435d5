// Places at which the mesh resolves two singular elements and the saddle between them, near the drawn ones.
//
// A piecewise field has a zero of index +1 or -1 only where the field rotates by less than pi along every edge, and no
// two zeros share a face. Elements that are about to merge come closer than that. Up to the meeting point they are
// therefore moved, by less than an edge length, to places at which the field
//     (z - a) (z - b) conj(z - s)
// rotates by clearly less than pi along all edges nearby. The places are searched in the flat coordinates around the
// middle of the pair.
#pragma once

#include <optional>

#include "design/log_map.h"
#include "mesh/closest_point.h"

namespace stormfield {

struct PairPlacement {
  SurfacePoint a, b, saddle;
};

/// a and b are where the paths are; `axis` points from b to a in space and counts when the two are closer than an edge.
/// Each element moves by less than `edge`. Nothing when no place was found: the mesh is too irregular or has its
/// boundary here.
std::optional<PairPlacement> placePair(const VertexCharts& charts, const ClosestPointQuery& query,
                                       const SurfacePoint& a, const SurfacePoint& b, const Vec3& axis, double edge,
                                       LogMapScratch& scratch);

}  // namespace stormfield
