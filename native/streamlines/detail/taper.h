// The width of lines: falling towards ends inside the surface, and where a line comes near one that was there before
// it.
#pragma once

#include <vector>

#include "base/progress.h"
#include "streamlines/detail/line_tracer.h"

namespace stormfield {

/// Per line and point a factor 0..1. Line i is number i in the samples.
std::vector<std::vector<double>> taperLines(const TriangleMesh& mesh, const std::vector<Line>& lines,
                                            const NearLines& samples, const LineRules& rules, Progress* progress);

}  // namespace stormfield
