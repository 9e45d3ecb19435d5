// Options and results of all tracers. A trace is the solution x(t) of dx/dt = V(x; t) through a seed
// (thesis 10.1.2): a streamline where V is steady, a pathline where it changes over time.
#pragma once

#include <limits>
#include <vector>

#include "base/words.h"
#include "mesh/surface_point.h"

namespace stormfield {

enum class Direction { Forward, Backward };
template <>
inline constexpr Words kWords<Direction>{"direction", {"forward", "backward"}};

/// What a particle does where the flow leaves the surface.
enum class BoundaryRule {
  Stop,   ///< the trace ends on the boundary
  Slide,  ///< it follows the tangential component along the boundary until the flow points inwards again
};
template <>
inline constexpr Words kWords<BoundaryRule>{"rule for the boundary", {"stop", "slide"}};

enum class StopReason {
  Time,       ///< maxTime was reached
  Length,     ///< maxLength was reached
  MinSpeed,   ///< steady flow slower than minSpeed: a fixed point is near
  Boundary,   ///< the flow leaves the surface here
  StepLimit,  ///< maxSteps were used
  Visitor,    ///< the caller's visitor returned false
};
template <>
inline constexpr Words kWords<StopReason>{"reason to stop",
                                          {"time", "length", "min_speed", "boundary", "step_limit", "visitor"}};

struct TraceOptions {
  Direction direction = Direction::Forward;
  double maxTime = std::numeric_limits<double>::infinity();    ///< seconds
  double maxLength = std::numeric_limits<double>::infinity();  ///< mesh units
  /// Largest estimated error of one step, in mean edge lengths.
  double tolerance = 1e-6;
  /// Steady flow only: as a fraction of the field's fastest vertex.
  double minSpeed = 1e-6;
  BoundaryRule boundary = BoundaryRule::Stop;
  /// Bounds work and memory of a trace that never ends otherwise.
  Index maxSteps = 100000;
};

struct TraceEnd {
  SurfacePoint point;
  double time = 0.0;    ///< seconds since the seed, positive in either direction
  double length = 0.0;  ///< mesh units
  StopReason reason = StopReason::Time;
  Index crossings = 0;  ///< edges stepped over
  Index steps = 0;      ///< steps of the integrator, rejected ones included
};

/// Trace i has the points offsets[i] to offsets[i + 1], from its seed to its end, one per edge crossing and step.
struct Traces {
  std::vector<std::size_t> offsets;
  std::vector<SurfacePoint> points;
  std::vector<double> times;  ///< per point, seconds since the seed
  std::vector<TraceEnd> ends;
};

/// Throws InputError for options without meaning (negative, not a number).
void checkOptions(const TraceOptions& options);
/// Throws InputError naming the first seed that is not a point of the mesh.
void checkSeeds(const TriangleMesh& mesh, const std::vector<SurfacePoint>& seeds);

}  // namespace stormfield
