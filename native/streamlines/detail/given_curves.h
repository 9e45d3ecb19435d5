// Given curves as lines: with evenly spaced points, and shortened where they come near another line.
#pragma once

#include "streamlines/detail/line_tracer.h"
#include "streamlines/evenly_spaced.h"

namespace stormfield {

/// Points of the curve at most step apart, and as a rule no nearer than 3/4 of it, except where the curve bends over an
/// edge.
std::vector<LinePoint> evenPoints(const TriangleMesh& mesh, const GivenCurve& curve, double step);

/// Adds the points to the lines, from the first on, until one comes nearer than the test distance to another line or to
/// an earlier part of the curve; the others are dropped. A closed curve is added whole. Other given curves that begin
/// at the same point are no obstacle near that point. starts: the first point of each line so far, this one included.
void addGivenCurve(std::vector<LinePoint>& points, bool closed, Index number, const LineRules& rules,
                   const std::vector<Vec3>& starts, const TriangleMesh& mesh, NearLines& lines);

}  // namespace stormfield
