// The steps of tracing/integrator.h: in closed form through a face, by the Runge-Kutta rule, and over an edge.
#pragma once

#include "tracing/dense_step.h"
#include "tracing/detail/integrator_class.h"

namespace stormfield {

/// One step, one crossing, or one change of the time segment. False when the trace has ended.
template <typename Flow>
bool Integrator<Flow>::advance() {
  if (isOver()) return false;
  if constexpr (kInClosedForm) {
    if (mayStep()) {
      FaceStep step;
      limits_.maxDuration = maxTime_ - elapsed_;
      if (stepThroughFace(faceFlow(), entry_, inside(), limits_, step) && fits(step)) return take(step);
    }
  }
  return takeSmallStep();
}

template <typename Flow>
bool Integrator<Flow>::take(const FaceStep& step) {
  elapsed_ = step.duration < maxTime_ - elapsed_ ? elapsed_ + step.duration : maxTime_;
  length_ += step.length;
  idleCrossings_ = 0;
  if (step.exit.side == kNoSide) {
    entry_ = SidePoint{};
    inside_ = step.barycentric;
    positioned_ = false;
    return true;
  }
  const Index twin = faceFlow().twin[step.exit.side];
  if (twin == kNone) return cross(step.exit.side, step.exit.fraction);
  ++end_.crossings;
  enter(TriangleMesh::face(twin));
  flow_.prefetch(face_);
  entry_ = {TriangleMesh::corner(twin), 1.0 - step.exit.fraction};
  positioned_ = false;
  return true;
}

/// Where no closed form holds: a step of the Runge-Kutta rule, a crossing that takes no time, a change of the segment.
template <typename Flow>
bool Integrator<Flow>::takeSmallStep() {
  locate();
  entry_ = SidePoint{};
  const double left = timeLeft();
  if (left <= 0.0) {
    flow_.advance(cursor_);
    enter(face_);
    return true;
  }
  load();
  if (slide_ != kNoSide && flowsInward(slide_, position_, elapsed_)) slide_ = kNoSide;
  const Complex k1 = followed(position_, elapsed_);
  if (Flow::kSteady && std::norm(k1) <= squaredMinSpeed_) {
    return stop(slide_ == kNoSide ? StopReason::MinSpeed : StopReason::Boundary);
  }

  const Eigen::Vector3d b = flat_->barycentric(position_), rate = flat_->barycentricRate(k1);
  double exit = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (b[i] > kSlack && rate[i] < 0.0) exit = std::min(exit, -b[i] / rate[i]);
  }
  double h = std::min({trialStep_, left, kOvershoot * exit});
  // Two faces that each say the particle belongs to the other disagree by round-off: it then moves along their edge.
  const bool undecided = idleCrossings_ > 3;
  if (undecided) h = std::min(h, 1e-3 * std::abs(side(0)) / std::abs(k1));
  for (int i = 0; i < 3 && !undecided; ++i) {
    const int across = (i + 1) % 3;
    if (b[i] <= kSlack && b[i] + rate[i] * h < -kSlack && across != slide_) {
      ++idleCrossings_;
      return cross(across, fractionAlong(across, position_));
    }
  }
  if (h == std::numeric_limits<double>::infinity()) return stop(StopReason::MinSpeed);  // the field is zero here
  return integrate(h, b, k1, rate);
}

template <typename Flow>
bool Integrator<Flow>::integrate(double h, const Eigen::Vector3d& b, Complex k1, const Eigen::Vector3d& rate) {
  const double speed1 = magnitude(k1);
  double speed5 = 0.0;
  Complex k2, k3, k4, k5, to;
  while (true) {
    k2 = followed(position_ + h / 3.0 * k1, elapsed_ + h / 3.0);
    k3 = followed(position_ + h / 6.0 * (k1 + k2), elapsed_ + h / 3.0);
    k4 = followed(position_ + h / 8.0 * (k1 + 3.0 * k3), elapsed_ + 0.5 * h);
    k5 = followed(position_ + h * (0.5 * k1 - 1.5 * k3 + 2.0 * k4), elapsed_ + h);
    to = position_ + h / 6.0 * (k1 + 4.0 * k4 + k5);
    const double error = h / 30.0 * magnitude(2.0 * k1 - 9.0 * k3 + 8.0 * k4 - k5);
    speed5 = magnitude(k5);
    const double path = h * std::max(speed1, speed5);
    // Near a fixed point the path is short: the error has to shrink with it for the trace to converge.
    const double allowed = std::min(tolerance_, kRelativeError * path);
    const double growth = std::clamp(0.9 * std::sqrt(std::sqrt(allowed / std::max(error, 1e-3 * allowed))), 0.1, 4.0);
    if (error <= allowed || path < 1e-3 * tolerance_) {
      trialStep_ = growth < 1.0 ? h * growth : std::max(trialStep_, h * growth);
      break;
    }
    if (end_.steps++ >= options_.maxSteps) return stop(StopReason::StepLimit);
    trialStep_ = h *= std::isfinite(error) ? std::min(growth, 0.9) : 0.1;
  }

  const double fullLength = h / 6.0 * (speed1 + 4.0 * magnitude(k4) + speed5);
  const DenseStep step{position_, to, k1, k5, speed1, speed5, h, fullLength};
  const Eigen::Vector3d bTo = flat_->barycentric(to), rateTo = flat_->barycentricRate(k5);
  double fraction = 1.0;
  int across = kNoSide;
  for (int i = 0; i < 3; ++i) {
    if ((i + 1) % 3 == slide_) continue;
    const bool fromEdge = b[i] <= kSlack;
    if (fromEdge && rate[i] <= 0.0) {
      // Along the edge at first: a path that then leaves over it belongs to the other face from the start.
      if (bTo[i] < -kSlack && idleCrossings_ <= 3) {
        ++idleCrossings_;
        return cross((i + 1) % 3, fractionAlong((i + 1) % 3, position_));
      }
      continue;
    }
    const double root = firstExit(fromEdge ? 0.0 : b[i], h * rate[i], bTo[i], h * rateTo[i], kSlack);
    if (root < fraction) {
      fraction = root;
      across = (i + 1) % 3;
    }
  }
  if (slide_ != kNoSide && flowsInward(slide_, step.point(fraction), elapsed_ + fraction * h)) {
    // The flow starts to point inwards within the step: leave the boundary there.
    double outward = 0.0;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (outward + fraction);
      (flowsInward(slide_, step.point(middle), elapsed_ + middle * h) ? fraction : outward) = middle;
    }
    across = kNoSide;
  }
  double length = step.arcLength(fraction);
  if (length_ + length >= options_.maxLength) {
    fraction = step.fractionOfLength(options_.maxLength - length_, fraction);
    length = options_.maxLength - length_;
    across = kNoSide;
  }
  position_ = fraction < 1.0 ? step.point(fraction) : to;
  length_ += length;
  idleCrossings_ = 0;
  if (fraction < 1.0 || h < maxTime_ - elapsed_) {
    const bool segmentEnds = fraction == 1.0 && h >= flow_.remaining(cursor_, time());
    elapsed_ += fraction * h;
    if (segmentEnds) {
      flow_.advance(cursor_);
      enter(face_);
    }
  } else {
    elapsed_ = maxTime_;
  }
  return across == kNoSide || cross(across, fractionAlong(across, position_));
}

/// Over a side of the face, at a fraction of its length from its tail.
template <typename Flow>
bool Integrator<Flow>::cross(int i, double fraction) {
  if (fraction < kSnap) return leaveVertex(i);
  if (fraction > 1.0 - kSnap) return leaveVertex((i + 1) % 3);
  const Index twin = flat_->twin(i);
  position_ = flat_->corner(i) + fraction * side(i);
  positioned_ = true;
  entry_ = SidePoint{};
  if (twin == kNone) {
    if (options_.boundary == BoundaryRule::Stop) return stop(StopReason::Boundary);
    slide_ = i;
    return true;
  }
  ++end_.crossings;
  slide_ = kNoSide;
  enter(TriangleMesh::face(twin));
  const int back = TriangleMesh::corner(twin);
  position_ = flat_->corner(back) + (1.0 - fraction) * side(back);
  entry_ = {back, 1.0 - fraction};
  return true;
}

}  // namespace stormfield
