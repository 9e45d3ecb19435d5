// The return map of a section: where a streamline that starts on it next crosses it (Poincare map; thesis 3.1). Its
// fixed points are the periodic orbits that cross the section.
//
//   ReturnMap returns(trace, section, 1, componentOf, component, 1000);
//   const std::optional<Return> back = returns(0.5 * (section.low() + section.high()));
#pragma once

#include <optional>

#include "topology/detail/section.h"

namespace stormfield {

struct Return {
  double position;  ///< on the section
  double time;      ///< seconds
  double length;    ///< mesh units
  Index crossings;  ///< of edges and vertices
};

/// Copies are cheap and independent: one per thread. The section and componentOf are kept by reference.
class ReturnMap {
 public:
  /// loops: number of crossings of the section until the streamline counts as back (more than one only where an orbit
  /// winds around a handle). A streamline does not return that leaves the recurrent component (the faces with this
  /// number in componentOf), or that crosses more than maxCrossings edges.
  ReturnMap(const CrossingTrace& trace, const Section& section, int loops, const std::vector<Index>& componentOf,
            Index component, Index maxCrossings)
      : trace_(trace),
        section_(&section),
        loops_(loops),
        componentOf_(&componentOf),
        component_(component),
        maxCrossings_(maxCrossings) {}

  std::optional<Return> operator()(double position) {
    return run(position, [](const SurfacePoint&, double, const EdgePassage&) {});
  }
  /// As above; visit(SurfacePoint, seconds, EdgePassage) sees the streamline.
  template <typename Visit>
  std::optional<Return> run(double position, Visit&& visit);

  const Section& section() const { return *section_; }
  Direction direction() const { return trace_.direction(); }
  int loops() const { return loops_; }

 private:
  /// Steps inside one face after which a streamline is taken to stay there. Orbits of two or three faces, close around
  /// a focus, take hundreds.
  static constexpr int kMaxIdleSteps = 5000;

  CrossingTrace trace_;
  const Section* section_;
  int loops_;
  const std::vector<Index>* componentOf_;
  Index component_;
  Index maxCrossings_;
};

template <typename Visit>
std::optional<Return> ReturnMap::run(double position, Visit&& visit) {
  const TriangleMesh& mesh = trace_.faces().mesh();
  std::optional<Return> result;
  int loopsLeft = loops_;
  Index crossings = 0;
  int idleSteps = 0;
  double lastLoop = 0.0;  // seconds
  bool started = false;
  const auto end = trace_.run(section_->point(mesh, position, trace_.direction()),
                              [&](const SurfacePoint& p, double time, const EdgePassage& passage) {
                                visit(p, time, passage);
                                // A start at a vertex reports a passage of its own, at time 0.
                                const bool leaving = !started;
                                started = started || passage || time > 0.0;
                                if (!passage && ++idleSteps > kMaxIdleSteps) return false;
                                if (leaving || !passage) return true;
                                idleSteps = 0;
                                if ((*componentOf_)[p.face] != component_ || ++crossings > maxCrossings_) return false;
                                const auto at = section_->at(mesh, passage);
                                // Along an edge its two faces may hand the streamline back and forth in no time.
                                const bool loop = at && time > lastLoop;
                                if (loop) lastLoop = time;
                                if (loop && --loopsLeft == 0) result = Return{*at, time, 0.0, crossings};
                                return loopsLeft > 0;
                              });
  if (result) result->length = end.length;
  return result;
}

}  // namespace stormfield
