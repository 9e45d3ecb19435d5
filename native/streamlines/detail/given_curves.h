// Given curves as lines: with evenly spaced points, and shortened where they come near another line.
#pragma once

#include "streamlines/detail/line_tracer.h"
#include "streamlines/evenly_spaced.h"

namespace stormfield {

/// Points at most step apart, and hardly nearer than that, except where the curve bends over an edge.
std::vector<LinePoint> evenPoints(const TriangleMesh& mesh, const GivenCurve& curve, double step);

/// Adds the points, from the first on, to the lines until one comes nearer than the test distance to another line or to
/// an earlier part of the curve; the rest is dropped. A closed curve is added whole. Other given curves that begin at
/// the same point are no obstacle on their first pieces.
void addGivenCurve(std::vector<LinePoint>& points, bool closed, Index number, const LineRules& rules,
                   const std::vector<Vec3>& starts, const TriangleMesh& mesh, NearLines& lines);

}  // namespace stormfield
