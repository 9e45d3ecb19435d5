// The return map of a section: where a streamline that starts on it comes back to it (Poincare map, thesis 3.1).
#pragma once

#include <optional>

#include "topology/detail/section.h"

namespace stormfield {

struct Return {
  double position;  ///< on the section
  double time;      ///< seconds
  double length;    ///< mesh units
  Index crossings;
};

/// Copies are cheap and independent: one per thread.
class ReturnMap {
 public:
  /// loops: how many times the section is crossed until the streamline counts as back (more than one only where an
  /// orbit winds around a handle). A streamline that leaves the part (faces with this number in partOf), or has not
  /// come back after so many crossings, does not return.
  ReturnMap(const FlowWalk& walk, const Section& section, int loops, const std::vector<Index>& partOf, Index part,
            Index maximalCrossings)
      : walk_(walk),
        section_(&section),
        loops_(loops),
        partOf_(&partOf),
        part_(part),
        maximalCrossings_(maximalCrossings) {}

  std::optional<Return> operator()(double position) {
    return run(position, [](const SurfacePoint&, double, const EdgePassage&) {});
  }
  /// As above; visit(SurfacePoint, seconds, EdgePassage) sees the way.
  template <typename Visit>
  std::optional<Return> run(double position, Visit&& visit);

  const Section& section() const { return *section_; }
  Direction direction() const { return walk_.direction(); }
  int loops() const { return loops_; }
  Index maximalCrossings() const { return maximalCrossings_; }

 private:
  /// Steps inside one face after which a streamline will not leave it. Orbits of two or three faces, close around a
  /// focus, take hundreds.
  static constexpr int kIdleSteps = 5000;

  FlowWalk walk_;
  const Section* section_;
  int loops_;
  const std::vector<Index>* partOf_;
  Index part_;
  Index maximalCrossings_;
};

template <typename Visit>
std::optional<Return> ReturnMap::run(double position, Visit&& visit) {
  const TriangleMesh& mesh = walk_.faces().mesh();
  std::optional<Return> result;
  int left = loops_;
  Index crossings = 0;
  int idle = 0;
  double counted = 0.0;
  bool started = false;
  const auto end = walk_.run(section_->point(mesh, position, walk_.direction()),
                             [&](const SurfacePoint& p, double time, const EdgePassage& passage) {
                               visit(p, time, passage);
                               // Starting at a vertex is a passage of its own, within no time to speak of.
                               const bool leaving = !started;
                               started = started || passage || time > 0.0;
                               // Inside a face for good: around a focus.
                               if (!passage && ++idle > kIdleSteps) return false;
                               if (leaving || !passage) return true;
                               idle = 0;
                               if ((*partOf_)[p.face] != part_ || ++crossings > maximalCrossings_) return false;
                               const auto at = section_->at(mesh, passage);
                               // Along an edge its two faces may hand the streamline to and fro without any time.
                               const bool loop = at && time > counted;
                               if (loop) counted = time;
                               if (loop && --left == 0) result = Return{*at, time, 0.0, crossings};
                               return left > 0;
                             });
  if (result) result->length = end.length;
  return result;
}

}  // namespace stormfield
