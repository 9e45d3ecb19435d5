// Streamlines: traces of a steady field (thesis 10.1.2, definition 10.1.3).
//
//   const FlatFaces faces(field.charts);  // once per mesh, shared by all traces
//   const Traces lines = traceStreamlines(faces, field, seeds, {.maxLength = 2.0});
#pragma once

#include "base/progress.h"
#include "field/vector_field.h"
#include "tracing/flat_faces.h"
#include "tracing/trace.h"

namespace stormfield {

/// All throw InputError for a field of another mesh, bad seeds or options, and Cancelled; traces run in parallel and
/// are the same for any number of threads.
Traces traceStreamlines(const FlatFaces& faces, const VectorField& field, const std::vector<SurfacePoint>& seeds,
                        const TraceOptions& options, Progress* progress = nullptr);
/// The ends alone, without memory for the points between.
std::vector<TraceEnd> traceStreamlineEnds(const FlatFaces& faces, const VectorField& field,
                                          const std::vector<SurfacePoint>& seeds, const TraceOptions& options,
                                          Progress* progress = nullptr);
TraceEnd traceStreamline(const FlatFaces& faces, const VectorField& field, const SurfacePoint& seed,
                         const TraceOptions& options);

}  // namespace stormfield
