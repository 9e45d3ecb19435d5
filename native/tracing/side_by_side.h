// Several steady traces at a time, whose steps through faces are computed side by side (tracing/face_path.h). Every
// trace is the same as one that Integrator::run follows alone.
#pragma once

#include "tracing/integrator.h"

namespace stormfield {

/// Traces the seeds first <= i < last. Tells the visitor begin(lane, i), step(lane, integrator) after every step, and
/// end(lane, i, TraceEnd). Traces of one lane come one after the other.
template <typename Flow, typename Visitor>
void traceSideBySide(const Integrator<Flow>& prototype, const std::vector<SurfacePoint>& seeds, double maximalTime,
                     std::size_t first, std::size_t last, Visitor& visitor) {
  constexpr int kLanes = FaceSteps::kCount;
  struct Lane {
    Integrator<Flow> integrator;
    std::size_t trace;
    bool busy, waiting;  ///< has a trace; its step is set
  };
  std::vector<Lane> lanes(std::min<std::size_t>(kLanes, last - first), Lane{prototype, 0, false, false});
  FaceSteps steps;
  std::size_t next = first;

  // Until its next step is set, or no seed is left.
  const auto prepare = [&](Lane& lane, int i) {
    bool going = lane.busy;
    while (true) {
      while (going) {
        if (lane.integrator.isOver()) break;
        if (lane.integrator.ask(steps, i)) {
          lane.waiting = true;
          return;
        }
        going = lane.integrator.takeSmallStep();
        visitor.step(i, lane.integrator);
      }
      if (lane.busy) visitor.end(i, lane.trace, lane.integrator.end());
      lane.busy = next < last;
      if (!lane.busy) return;
      lane.trace = next++;
      visitor.begin(i, lane.trace);
      going = lane.integrator.begin(seeds[lane.trace], 0.0, maximalTime);
    }
  };
  const auto finish = [&](Lane& lane, int i) {
    FaceStep step;
    const FaceSteps::Outcome outcome = steps.take(i, step);
    if (outcome == FaceSteps::Outcome::Shorter) return;
    lane.waiting = false;
    const bool plain = outcome == FaceSteps::Outcome::Done && lane.integrator.fits(step);
    const bool going = plain ? lane.integrator.take(step) : lane.integrator.takeSmallStep();
    visitor.step(i, lane.integrator);
    if (!going) {
      visitor.end(i, lane.trace, lane.integrator.end());
      lane.busy = false;
    }
  };

  for (bool any = true; any;) {
    any = false;
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      if (!lanes[i].waiting) prepare(lanes[i], static_cast<int>(i));
      any |= lanes[i].waiting;
    }
    if (!any) break;
    steps.advance(prototype.limits());
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      if (lanes[i].waiting) finish(lanes[i], static_cast<int>(i));
    }
  }
}

}  // namespace stormfield
