// Where the particles of many pathlines are at chosen times, and nothing of the way there: for maps that take every
// vertex of a mesh along a flow.
//
// Eight pathlines are followed side by side, a face at a step (tracing/detail/unsteady_step.h); where that is not exact
// enough, near vertices and zeros of the field, the integrator of all other tracers takes over. Seeds that follow each
// other at the same point and time share one pathline.
//
//   const UnsteadyField flow(faces, field, {.times = {0, 10}, .lambdas = {0, 1}});
//   const auto places = traceArrivals(flow, {{seed, 2.5, 0.5}, {seed, 2.5, 1.0}}, {});  // at 3 s and at 3.5 s
#pragma once

#include "tracing/pathline.h"

namespace stormfield {

/// The place of each seed after its time; a particle that the boundary stops stays there. Of the options, direction,
/// tolerance and maxSteps apply. Pathlines of seeds that lie near each other in the list are fastest where they also do
/// on the surface. Throws InputError for bad seeds or options and for times that are not finite, and Cancelled. Parallel,
/// the same for any number of threads.
std::vector<SurfacePoint> traceArrivals(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds,
                                        const TraceOptions& options, Progress* progress = nullptr);

}  // namespace stormfield
