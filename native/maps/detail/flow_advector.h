// PointAdvector for one type of flow, by the integrator of tracing/.
#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "base/progress.h"
#include "maps/detail/divergence_bound.h"
#include "maps/point_advector.h"
#include "tracing/flow.h"
#include "tracing/integrator.h"
#include "tracing/side_by_side.h"

namespace stormfield {

/// The state of one trace. The integrator ends a trace after a number of steps; in a face that is almost a line they
/// may not reach tau. The trace then continues in a further stretch, as long as stretches advance it.
class StretchedTrace {
 public:
  StretchedTrace() = default;
  StretchedTrace(const AdvectedPoint& from, double tau)
      : from_(from.point), checked_(from.point), tau_(tau), radius_(from.radius), face_(from.point.face) {}

  /// Start of the current stretch.
  const SurfacePoint& from() const { return from_; }
  /// tau of the stretches before.
  double doneTau() const { return doneTau_; }
  double remainingTau() const { return tau_ - doneTau_; }

  /// Counts a step of the integrator to here(). False: the trace is stationary.
  template <typename Here>
  bool countStep(const Here& here) {
    if (++steps_ % kStationarySteps != 0) return true;
    const SurfacePoint p = here();
    const bool moves =
        !(p.face == checked_.face && (p.barycentric - checked_.barycentric).cwiseAbs().maxCoeff() < kStationary);
    checked_ = p;
    return moves;
  }
  /// Grows the radius by a step that ends in a face, `tau` after the start of the stretch.
  void growRadius(const DivergenceBound& bound, Index face, double tau) {
    radius_ = bound.after(radius_, face_, tau - stretchTau_);
    face_ = face;
    stretchTau_ = tau;
  }
  /// Ends a stretch; whether another one follows.
  bool endStretch(const TraceEnd& end) {
    if (end.reason != StopReason::StepLimit || !(end.time > kMinAdvance * tau_)) return false;
    from_ = end.point;
    doneTau_ += end.time;
    stretchTau_ = 0.0;
    return true;
  }
  AdvectedPoint image(const TraceEnd& end) const { return {end.point, end.reason == StopReason::Boundary, radius_}; }

 private:
  /// Fraction of tau by which a stretch has to advance the trace: less is round-off of a trace that is stuck.
  static constexpr double kMinAdvance = 1e-6;
  /// A trace is stationary when it moves by less than kStationary (barycentric) in kStationarySteps steps: it has
  /// reached a sink as nearly as double precision tells.
  static constexpr unsigned kStationarySteps = 64;
  static constexpr double kStationary = 1e-8;

  SurfacePoint from_, checked_;
  double tau_ = 0.0, doneTau_ = 0.0, stretchTau_ = 0.0, radius_ = 0.0;
  Index face_ = kNone;
  unsigned steps_ = 0;
};

template <typename Flow>
class FlowAdvector final : public PointAdvector {
 public:
  /// bound: of the radius of images, or null. What is pointed to must outlive the advector.
  FlowAdvector(const FlatFaces& faces, const Flow& flow, const TraceOptions& options, const DivergenceBound* bound,
               const Progress* progress)
      : integrator_(faces, flow, options, 0.0), bound_(bound), progress_(progress) {}

  AdvectedPoint advect(const AdvectedPoint& from, double tau) override {
    return trace(from, tau, [](const SurfacePoint&, double) {});
  }

  void advectAll(AdvectionQueue& queue) override {
    if constexpr (std::is_same_v<Flow, SteadyFlow>) {
      SideBySide work{*this, queue, {}, {}};
      traceSideBySide(integrator_, work);
    } else {
      AdvectedPoint from;
      double tau = 0.0;
      while (queue.next(0, from, tau)) queue.arrive(0, advect(from, tau));
    }
  }

  std::vector<TrajectoryPoint> trajectory(const SurfacePoint& from, double tau) override {
    std::vector<TrajectoryPoint> points;
    trace({.point = from}, tau, [&](const SurfacePoint& p, double at) { points.push_back({p, at}); });
    return points;
  }

 private:
  template <typename Visit>
  AdvectedPoint trace(const AdvectedPoint& from, double tau, const Visit& visit) {
    StretchedTrace state(from, tau);
    while (true) {
      const TraceEnd end =
          integrator_.run(state.from(), 0.0, state.remainingTau(), [&](const SurfacePoint& p, double at) {
            checkProgress();
            visit(p, state.doneTau() + at);
            if (bound_ != nullptr) state.growRadius(*bound_, p.face, at);
            return state.countStep([&] { return p; });
          });
      if (!state.endStretch(end)) return state.image(end);
    }
  }

  static_assert(FaceSteps::kCount <= AdvectionQueue::kMaxLanes);
  /// What traceSideBySide asks for: a queue's points, as traces.
  struct SideBySide {
    FlowAdvector& advector;
    AdvectionQueue& queue;
    std::array<StretchedTrace, AdvectionQueue::kMaxLanes> states;
    std::array<bool, AdvectionQueue::kMaxLanes> continues;

    bool next(int lane, SurfacePoint& seed, double& maxTime) {
      StretchedTrace& state = states[lane];
      if (!continues[lane]) {
        AdvectedPoint from;
        double tau = 0.0;
        if (!queue.next(lane, from, tau)) return false;
        state = StretchedTrace(from, tau);
      }
      seed = state.from();
      maxTime = state.remainingTau();
      state.countStep([&] { return seed; });  // as Integrator::run visits the start
      return true;
    }
    bool step(int lane, const Integrator<Flow>& integrator) {
      advector.checkProgress();
      if (advector.bound_ != nullptr) {
        states[lane].growRadius(*advector.bound_, integrator.here().face, integrator.elapsed());
      }
      return states[lane].countStep([&] { return integrator.here(); });
    }
    void end(int lane, const TraceEnd& traceEnd) {
      continues[lane] = states[lane].endStretch(traceEnd);
      if (!continues[lane]) queue.arrive(lane, states[lane].image(traceEnd));
    }
  };

  /// Every 1024 steps: the look at an atomic costs more than a step.
  void checkProgress() {
    if (progress_ != nullptr && (++steps_ & 1023) == 0) progress_->check();
  }

  Integrator<Flow> integrator_;
  const DivergenceBound* bound_;
  const Progress* progress_;
  unsigned steps_ = 0;
};

}  // namespace stormfield
