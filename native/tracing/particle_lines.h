// Streaklines and timelines: where at one time the particles of a family are (thesis 10.1.2).
//
// A streakline joins the particles released one after the other at one point; a timeline joins those released at one
// time along a curve. Where neighbours come to lie farther apart than the spacing, particles between them join the
// family: they are traced from their own release, not put on a chord, so that every point of a line is the end of
// a true pathline, and a line does not depend on the times of earlier ones. Where no particle
// between two neighbours fills the gap (they passed a saddle or a hole on different sides) the line is torn.
//
//   const UnsteadyField flow(faces, field, {.times = {0, 10}, .lambdas = {0, 1}});
//   const auto smoke = traceStreaklines(flow, {seed}, 0.0, {1, 2, 3}, {.spacing = 0.01});  // smoke[2]: the lines at 3 s
//   const auto fronts = traceTimelines(flow, {curve}, 0.0, {1, 2, 3}, {.spacing = 0.01});
#pragma once

#include "tracing/pathline.h"

namespace stormfield {

struct LineOptions {
  /// Largest distance of neighbours, mesh units; infinity: no particles beyond those that are given.
  double spacing = std::numeric_limits<double>::infinity();
  /// Streaklines: largest time between two releases, seconds.
  double interval = std::numeric_limits<double>::infinity();
  double tolerance = TraceOptions{}.tolerance;  ///< as in TraceOptions
  BoundaryRule boundary = BoundaryRule::Stop;   ///< a particle that the boundary stops stays there
  Index maxParticles = 100000;                  ///< of one line
};

/// The lines at one time. Line i has the particles offsets[i] to offsets[i + 1].
struct ParticleLines {
  double time = 0.0;  ///< seconds
  std::vector<std::size_t> offsets;
  std::vector<SurfacePoint> points;
  std::vector<double> ages;  ///< seconds since release
  /// Identifies a particle of a line, increasing along it: the time of release (streaklines); the place along the
  /// given curve, k + f for the fraction f between its points k and k + 1 (timelines).
  std::vector<double> parameters;
  std::vector<char> torn;  ///< whether the line is torn between this particle and the next
};

/// Streaklines of the seeds at each of the times (increasing, not before start), by release from start on: from the
/// oldest particle to the one just released. Throws InputError for bad seeds, times or options, and for a line of more
/// than maxParticles; Cancelled. Parallel, the same for any number of threads.
std::vector<ParticleLines> traceStreaklines(const UnsteadyField& flow, const std::vector<SurfacePoint>& seeds,
                                            double start, const std::vector<double>& times, const LineOptions& options,
                                            Progress* progress = nullptr);
/// Timelines that lie on the curves at time start. A curve is a list of points joined by shortest lines (a closed one
/// ends where it starts); neighbours should be near each other compared to how the surface bends.
std::vector<ParticleLines> traceTimelines(const UnsteadyField& flow,
                                          const std::vector<std::vector<SurfacePoint>>& curves, double start,
                                          const std::vector<double>& times, const LineOptions& options,
                                          Progress* progress = nullptr);

}  // namespace stormfield
