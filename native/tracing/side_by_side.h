// Several steady traces at a time, whose steps through faces are computed side by side (tracing/face_path.h). Every
// trace is the same as one that Integrator::run follows alone.
#pragma once

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <vector>

#include "tracing/integrator.h"

namespace stormfield {

/// Traces the seeds of `work` until next() returns false for every lane; end() may add seeds. The work has
///     bool next(int lane, SurfacePoint& seed, double& maxTime)    the lane's next trace; false: there is none now
///     bool step(int lane, const Integrator<Flow>& integrator)     after every step; false ends the trace
///     void end(int lane, const TraceEnd& end)
/// A lane has one trace at a time.
template <typename Flow, typename Work>
void traceSideBySide(const Integrator<Flow>& prototype, Work& work) {
  struct Lane {
    Integrator<Flow> integrator;
    bool busy;  ///< has a trace
  };
  std::vector<Lane> lanes(FaceSteps::kCount, Lane{prototype, false});
  FaceSteps steps(prototype.limits());

  const auto end = [&](Lane& lane, int i, bool wanted) {
    TraceEnd traceEnd = lane.integrator.end();
    if (!wanted) traceEnd.reason = StopReason::Visitor;
    lane.busy = false;
    work.end(i, traceEnd);
  };
  // Until its next step is set; false where the lane has no trace.
  const auto prepare = [&](Lane& lane, int i) {
    bool going = lane.busy, wanted = true;
    while (true) {
      while (going && wanted) {
        if (lane.integrator.isOver()) break;
        if (lane.integrator.ask(steps, i)) return true;
        going = lane.integrator.takeSmallStep();
        wanted = work.step(i, lane.integrator);
      }
      if (lane.busy) end(lane, i, wanted);
      SurfacePoint seed;
      double maxTime = 0.0;
      if (!work.next(i, seed, maxTime)) return false;
      lane.busy = wanted = true;
      going = lane.integrator.begin(seed, 0.0, maxTime);
    }
  };
  const auto finish = [&](Lane& lane, int i) {
    FaceStep step;
    const FaceSteps::Outcome outcome = steps.take(i, step);
    if (outcome == FaceSteps::Outcome::Again) return false;
    const bool plain = outcome == FaceSteps::Outcome::Done && lane.integrator.fits(step);
    const bool going = plain ? lane.integrator.take(step) : lane.integrator.takeSmallStep();
    const bool wanted = work.step(i, lane.integrator);
    if (!going || !wanted) end(lane, i, wanted);
    return true;
  };

  // A lane without a trace asks again after each step of another one, which may have added seeds.
  std::array<int, FaceSteps::kCount> idle;
  std::iota(idle.begin(), idle.end(), 0);
  auto lastIdle = idle.end();
  while (true) {
    lastIdle = std::remove_if(idle.begin(), lastIdle, [&](int i) { return prepare(lanes[i], i); });
    const std::span<const int> advanced = steps.advance();
    if (advanced.empty()) return;
    for (const int i : advanced) {
      if (finish(lanes[i], i)) *lastIdle++ = i;
    }
  }
}

/// Traces the seeds first <= i < last. Calls the visitor's begin(lane, i), step(lane, integrator) after every step, and
/// end(lane, i, TraceEnd).
template <typename Flow, typename Visitor>
void traceSideBySide(const Integrator<Flow>& prototype, const std::vector<SurfacePoint>& seeds, double maxTime,
                     std::size_t first, std::size_t last, Visitor& visitor) {
  struct Seeds {
    const std::vector<SurfacePoint>& seeds;
    double maxTime;
    std::size_t at, last;
    Visitor& visitor;
    std::array<std::size_t, FaceSteps::kCount> traces{};

    bool next(int lane, SurfacePoint& seed, double& time) {
      if (at == last) return false;
      traces[lane] = at++;
      visitor.begin(lane, traces[lane]);
      seed = seeds[traces[lane]];
      time = maxTime;
      return true;
    }
    bool step(int lane, const Integrator<Flow>& integrator) {
      visitor.step(lane, integrator);
      return true;
    }
    void end(int lane, const TraceEnd& traceEnd) { visitor.end(lane, traces[lane], traceEnd); }
  };
  Seeds work{seeds, maxTime, first, last, visitor};
  traceSideBySide(prototype, work);
}

}  // namespace stormfield
