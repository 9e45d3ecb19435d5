// The taper of lines: a factor for their width that falls towards ends inside the surface, and where a line comes near
// an earlier one (Jobard and Lefer 1997).
#pragma once

#include <vector>

#include "base/progress.h"
#include "streamlines/detail/line_tracer.h"

namespace stormfield {

/// Per line and point a factor 0..1. Line i is number i in the samples. Given curves taper at their ends only.
std::vector<std::vector<double>> taperLines(const TriangleMesh& mesh, const std::vector<Line>& lines,
                                            const NearLines& samples, const LineRules& rules, Progress* progress);

}  // namespace stormfield
