// From design elements to the constraints of the space-time solve (thesis 5.2.2, 11.1.3).
//
//   ConstraintSet constraints = elementConstraints(charts, elements, {.samples = 100});
//   SpaceTimeResult result = SpaceTimeSolver(charts, {.samples = 100}).solve(constraints, progress);
//
// Samples lie evenly at lambda_j = j / (samples - 1). Every element acts on a region of its radius with soft weights
// that are densities over surface and lambda, so that one design gives one field at every resolution. Singular elements
// displace curves and arrows inside their discs; elements of other types blend where their rims overlap.
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "design/element.h"
#include "design/log_map_cache.h"
#include "mesh/vertex_charts.h"
#include "solver/constraint.h"
#include "solver/space_time_solver.h"

namespace stormfield {

struct ElementOptions {
  Index samples = SpaceTimeOptions().samples;
  /// s in d lambda = s dt, 1/s: converts the speed of pathlines along lambda to mesh units per second.
  double lambdaPerSecond = 1.0;
  /// Weight in the middle of a region, in units of 1 / radius^2 (lengths relative to the mesh size): the solved field
  /// adapts to its surroundings over radius / sqrt(stiffness).
  double stiffness = 1e4;
};

/// Brush strokes are passed over (brush.h). Sorted by sample, then vertex; the same for any number of threads. Throws InputError as checkElements does, when a
/// point lies off the surface, when singular elements meet in a way that cannot be joined, and when the cores of two
/// elements require contradicting vectors at one vertex and lambda (names both); Cancelled through progress. kept: maps
/// from the designs before it, and for those after it.
ConstraintSet elementConstraints(const std::shared_ptr<const VertexCharts>& charts,
                                 const std::vector<DesignElement>& elements, const ElementOptions& options,
                                 Progress* progress = nullptr, LogMapCache* kept = nullptr);

}  // namespace stormfield
