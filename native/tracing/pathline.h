// Pathlines: traces of a field that changes, along a lambda track (thesis 10.1.2, definition 10.1.2).
//
//   const UnsteadyField flow(faces, field, {.times = {0, 10}, .lambdas = {0, 1}});
//   const Traces lines = tracePathlines(flow, {{seed, 2.5, 1.0}}, {});  // from 2.5 s to 3.5 s
//
// Options apply as to streamlines, but minSpeed does not: the field at a stationary particle may change later.
// A particle that the boundary stops stays there: its end has the time at which it got there.
#pragma once

#include "base/progress.h"
#include "tracing/detail/lambda_track.h"
#include "tracing/flat_faces.h"
#include "tracing/trace.h"

namespace stormfield {

/// A field with its course in time, prepared once for many traces. The faces and the field must outlive it.
struct UnsteadyField {
  /// speed multiplies all velocities. Throws InputError for a field of another mesh or a track without meaning.
  UnsteadyField(const FlatFaces& faces, const ParameterizedField& field, const LambdaTrack& track, double speed = 1.0);

  const FlatFaces* faces;
  const ParameterizedField* field;
  std::vector<TimeSegment> segments;
  double speed;
};

struct PathlineSeed {
  SurfacePoint point;
  double time = 0.0;                                         ///< seconds at which the particle is there
  double maxTime = std::numeric_limits<double>::infinity();  ///< seconds to follow it; TraceOptions has another
};

Traces tracePathlines(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds, const TraceOptions& options,
                      Progress* progress = nullptr);
/// The ends alone, without memory for the points between.
std::vector<TraceEnd> tracePathlineEnds(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds,
                                        const TraceOptions& options, Progress* progress = nullptr);

}  // namespace stormfield
