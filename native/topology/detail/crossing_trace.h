// A trace of a steady field that reports every edge or vertex it crosses: what return maps and sections need besides
// the points of tracing/streamline.h.
//
//   CrossingTrace trace(faces, field, Direction::Forward, 1e-6);
//   trace.run(seed, [](const SurfacePoint&, double, const EdgePassage& passage) { return !passage; });
#pragma once

#include <limits>

#include "tracing/integrator.h"

namespace stormfield {

/// The edge or vertex that a step crosses, if any.
struct EdgePassage {
  /// The halfedge whose face the flow enters. A trace against the flow leaves that face.
  Index halfedge = kNone;
  double fraction = 0.0;  ///< along that halfedge, 0 at its tail
  Index vertex = kNone;   ///< in place of the halfedge

  explicit operator bool() const { return halfedge != kNone || vertex != kNone; }
};

/// Copies are cheap and independent: one per thread.
class CrossingTrace {
 public:
  /// tolerance: of one step, in mean edge lengths.
  CrossingTrace(const FlatFaces& faces, const VectorField& field, Direction direction, double tolerance)
      : faces_(faces),
        backward_(direction == Direction::Backward),
        integrator_(faces, SteadyFlow(field.values.data(), backward_ ? -1.0 : 1.0), options(direction, tolerance),
                    minSpeed(field)) {}

  /// visit(SurfacePoint, seconds, EdgePassage) -> bool, false to end; for the seed and after every step.
  template <typename Visit>
  TraceEnd run(const SurfacePoint& seed, Visit&& visit) {
    bool first = true;
    return integrator_.run(seed, 0.0, std::numeric_limits<double>::infinity(),
                           [&](const SurfacePoint& p, double time) -> bool {
                             const EdgePassage passage = first ? EdgePassage{} : lastPassage(p.face);
                             first = false;
                             return visit(p, time, passage);
                           });
  }

  const FlatFaces& faces() const { return faces_; }
  Direction direction() const { return backward_ ? Direction::Backward : Direction::Forward; }

 private:
  static TraceOptions options(Direction direction, double tolerance) {
    TraceOptions result;
    result.direction = direction;
    result.tolerance = tolerance;
    result.maxSteps = std::numeric_limits<Index>::max();
    return result;
  }
  /// A billionth of the fastest vertex: slower flow counts as a fixed point.
  static double minSpeed(const VectorField& field) {
    double squared = 0.0;
    for (const Complex& v : field.values) squared = std::max(squared, std::norm(v));
    return 1e-9 * std::sqrt(squared);
  }

  /// What the last step crossed before it entered the face where it ended.
  EdgePassage lastPassage(Index face) const {
    if (const Index vertex = integrator_.leftVertex(); vertex != kNone) return {kNone, 0.0, vertex};
    const SidePoint& entry = integrator_.entry();
    if (entry.side < 0) return {};
    const Index h = TriangleMesh::halfedge(face, entry.side);
    if (backward_) return {faces_.mesh().twin(h), 1.0 - entry.fraction, kNone};
    return {h, entry.fraction, kNone};
  }

  const FlatFaces& faces_;
  bool backward_;
  Integrator<SteadyFlow> integrator_;
};

}  // namespace stormfield
