// The one integrator behind streamlines and pathlines: dx/dt = V(x; t) on the surface, face by face in flat frames.
//
// A steady flow takes most faces in one step (tracing/face_path.h), which may also be computed outside, for several
// particles side by side (tracing/side_by_side.h). Elsewhere Merson's fourth-order Runge-Kutta rule
// estimates and controls the error; a step is tried a little farther than the straight exit from the face, and where
// the cubic through its ends crosses an edge, it ends on that edge, at the same point for both faces. Because the field
// is continuous across edges, following an edge or touching it needs no special case beyond a slack of round-off size.
// A trace that meets a vertex leaves it in the direction that the vertex's own vector has in its chart, which is the
// one direction that is right for any sum of corner angles. Nothing is allocated.
#pragma once

#include <array>
#include <numbers>
#include <type_traits>

#include "tracing/dense_step.h"
#include "tracing/detail/face_steps.h"
#include "tracing/flow.h"
#include "tracing/trace.h"

namespace stormfield {

template <typename Flow>
class Integrator {
 public:
  /// direction +1 or -1 only says how physical time runs; the flow's velocities already point the way to go.
  Integrator(const FlatFaces& faces, const Flow& flow, const TraceOptions& options, double minSpeed)
      : faces_(faces),
        flow_(flow),
        options_(options),
        timeSign_(options.direction == Direction::Backward ? -1.0 : 1.0),
        tolerance_(options.tolerance * faces.mesh().meanEdgeLength()),
        squaredMinSpeed_(minSpeed * minSpeed),
        limits_{tolerance_, kRelativeStepError, squaredMinSpeed_, 0.0} {}

  /// visit(SurfacePoint, seconds since the seed) is called for the seed and after every step and crossing. It may
  /// return a bool: false ends the trace.
  template <typename Visit>
  TraceEnd run(const SurfacePoint& seed, double startTime, double maxTime, Visit&& visit) {
    reset(startTime, maxTime);
    const auto wanted = [&](const SurfacePoint& p) {
      if constexpr (std::is_same_v<std::invoke_result_t<Visit&, const SurfacePoint&, double>, bool>) {
        return visit(p, elapsed_) || stop(StopReason::Visitor);
      } else {
        visit(p, elapsed_);
        return true;
      }
    };
    if (!wanted(seed)) {
      end_.point = seed;
      return end_;
    }
    bool going = place(seed);
    while (going) {
      going = advance();
      going = wanted(here()) && going;
    }
    return end();
  }

  // The same in parts, for steps that are computed outside. begin and take tell whether the trace goes on.

  bool begin(const SurfacePoint& seed, double startTime, double maxTime) {
    reset(startTime, maxTime);
    return place(seed);
  }
  /// Whether a limit is reached: then the trace has ended, else a step has been counted.
  bool isOver() {
    if (end_.steps++ >= options_.maxSteps) return !stop(StopReason::StepLimit);
    if (elapsed_ >= maxTime_) return !stop(StopReason::Time);
    if (length_ >= options_.maxLength) return !stop(StopReason::Length);
    return false;
  }
  /// Sets the next step through the face at hand; false where it cannot be in closed form.
  bool ask(FaceSteps& steps, int i) {
    if (!mayStep()) return false;
    steps.set(i, faceFlow(), entry_, inside(), maxTime_ - elapsed_);
    return true;
  }
  const StepLimits& limits() const { return limits_; }
  /// Goes a step in closed form, if it is within the limits of the trace; else false and nothing done.
  bool fits(const FaceStep& step) const { return length_ + step.length < options_.maxLength; }
  bool take(const FaceStep& step);
  bool takeSmallStep();
  SurfacePoint here() const {
    SurfacePoint p;
    here(p);
    return p;
  }
  /// Written number by number, and only written: what is read again as a whole at once would wait for that.
  void here(SurfacePoint& p) const {
    p.face = face_;
    double* b = p.barycentric.data();
    if (positioned_) {
      p.barycentric = flat_->barycentric(position_).cwiseMax(0.0);
      p.barycentric /= p.barycentric.sum();
    } else if (entry_.side == kNoSide) {
      b[0] = inside_[0];
      b[1] = inside_[1];
      b[2] = inside_[2];
    } else {
      const int next = entry_.side == 2 ? 0 : entry_.side + 1;
      b[entry_.side] = 1.0 - entry_.fraction;
      b[next] = entry_.fraction;
      b[3 - entry_.side - next] = 0.0;
    }
  }
  double elapsed() const { return elapsed_; }
  /// After a step: the side of the face at hand that it came in over, if it ended there.
  const SidePoint& entry() const { return entry_; }
  /// After a step: the vertex that it came upon and left, if any.
  Index leftVertex() const { return vertexStep_ == end_.steps ? vertex_ : kNone; }
  const TraceEnd& end() {
    end_.point = here();
    end_.time = elapsed_;
    end_.length = length_;
    return end_;
  }

 private:
  static constexpr int kNoSide = -1;
  /// Whether the flow is the interpolation of fixed vectors at the vertices.
  static constexpr bool kInClosedForm = requires(const Flow& flow, const FlatFace& face) { flow.vertexValues(face); };
  /// Barycentric round-off that does not count as outside; nearer to a vertex than kSnap is on it; a vertex is left by
  /// kLeave of an edge, far enough for a step in closed form to follow.
  static constexpr double kSlack = 1e-10, kSnap = 1e-9, kLeave = kInClosedForm ? 1e-5 : 1e-7;
  /// How far beyond the straight exit a step is tried, so that curved paths leave in one step as well.
  static constexpr double kOvershoot = 1.1;
  /// Largest error of a step as a fraction of its length, whatever the tolerance.
  static constexpr double kRelativeError = 0.02;
  /// The same of a step in closed form, which may go around a fixed point.
  static constexpr double kRelativeStepError = 1e-4;

  /// Finer tolerances, in mean edges, than what steps in closed form are good for.
  static constexpr double kFinest = 1e-9;
  bool mayStep() const { return slide_ == kNoSide && idleCrossings_ == 0 && options_.tolerance >= kFinest; }

  double time() const { return startTime_ + timeSign_ * elapsed_; }
  double timeLeft() const { return std::min(maxTime_ - elapsed_, flow_.remaining(cursor_, time())); }

  void reset(double startTime, double maxTime) {
    startTime_ = startTime;
    maxTime_ = maxTime;
    cursor_ = flow_.start(startTime);
    elapsed_ = length_ = 0.0;
    trialStep_ = std::numeric_limits<double>::infinity();
    slide_ = kNoSide;
    idleCrossings_ = 0;
    vertex_ = kNone;
    end_ = TraceEnd{};
  }

  bool stop(StopReason reason) {
    end_.reason = reason;
    return false;
  }

  void enter(Index face) {
    face_ = face;
    flat_ = &faces_[face];
    entry_ = SidePoint{};
    positioned_ = true;
    loaded_ = false;
  }
  /// Barycentric coordinates of the particle.
  Eigen::Vector3d inside() const {
    if (positioned_) return flat_->barycentric(position_);
    if (entry_.side == kNoSide) return inside_;
    Eigen::Vector3d b;
    b[entry_.side] = 1.0 - entry_.fraction;
    b[(entry_.side + 1) % 3] = entry_.fraction;
    b[(entry_.side + 2) % 3] = 0.0;
    return b;
  }
  /// Steps in closed form leave the position in the flat frame to those who need it.
  void locate() {
    if (positioned_) return;
    position_ = flat_->point(inside());
    positioned_ = true;
  }
  const FaceFlow& faceFlow() {
    if constexpr (kInClosedForm) {
      if (const FaceFlow* ready = flow_.prepared(face_)) return *ready;
      if (faceOfFlow_ != face_) {
        faceFlow_ = FaceFlow(*flat_, flow_.vertexValues(*flat_));
        faceOfFlow_ = face_;
      }
    }
    return faceFlow_;
  }
  /// Carries the vectors of the face at hand into its frame; needed before its velocities.
  void load() {
    if (loaded_) return;
    local_ = flow_.enter(*flat_, cursor_);
    loaded_ = true;
  }

  Complex side(int i) const { return flat_->corner((i + 1) % 3) - flat_->corner(i); }

  Complex velocity(Complex p, double elapsed) const {
    return flow_.velocity(*flat_, local_, cursor_, p, startTime_ + timeSign_ * elapsed);
  }
  /// The velocity that is followed: along a boundary, its tangential part.
  Complex followed(Complex p, double elapsed) const {
    const Complex v = velocity(p, elapsed);
    return slide_ == kNoSide ? v : project(v, side(slide_));
  }
  static Complex project(Complex v, Complex direction) {
    return (v.real() * direction.real() + v.imag() * direction.imag()) / std::norm(direction) * direction;
  }
  bool flowsInward(int i, Complex p, double elapsed) const {
    return flat_->barycentricRate(velocity(p, elapsed))[(i + 2) % 3] > 0.0;
  }

  bool place(const SurfacePoint& seed) {
    enter(seed.face);
    position_ = flat_->point(seed.barycentric);
    for (int i = 0; i < 3; ++i) {
      if (seed.barycentric[i] > 1.0 - kSnap) return leaveVertex(i);
    }
    for (int i = 0; i < 3; ++i) {
      if (seed.barycentric[i] == 0.0) enterFromSide((i + 1) % 3);
    }
    return true;
  }
  /// A seed on a side goes into the face that the flow takes it to, if there is one.
  void enterFromSide(int side) {
    load();
    const double fraction = fractionAlong(side, position_);
    if (flowsInward(side, position_, elapsed_)) {
      entry_ = {side, fraction};
    } else if (flat_->twin(side) != kNone) {
      cross(side, fraction);
    }
  }

  bool advance();
  bool integrate(double h, const Eigen::Vector3d& b, Complex k1, const Eigen::Vector3d& rate);
  bool cross(int side, double fraction);
  bool leaveVertex(int corner);
  bool leaveAlongBoundary(Index v, Complex velocity, Index lastHalfedge);
  void startAt(Index h, double distance, Complex direction);
  bool waitAtVertex(int corner);

  double fractionAlong(int i, Complex p) const {
    const Complex s = side(i), d = p - flat_->corner(i);
    return std::clamp((d.real() * s.real() + d.imag() * s.imag()) / std::norm(s), 0.0, 1.0);
  }

  const FlatFaces& faces_;
  Flow flow_;
  TraceOptions options_;
  double timeSign_, tolerance_, squaredMinSpeed_;
  StepLimits limits_;
  double startTime_ = 0.0, maxTime_ = 0.0;

  Index face_ = kNone;
  const FlatFace* flat_ = nullptr;
  typename Flow::Local local_;
  bool loaded_ = false;
  SidePoint entry_;         ///< where the particle entered the face, as long as it is there
  bool positioned_ = true;  ///< else it is at the entry, or at inside_
  Eigen::Vector3d inside_;  ///< barycentric coordinates after a step in closed form that ends inside
  FaceFlow faceFlow_;       ///< of the face faceOfFlow_
  Index faceOfFlow_ = kNone;
  typename Flow::Cursor cursor_;
  Complex position_;
  double elapsed_ = 0.0, length_ = 0.0, trialStep_ = 0.0;
  int slide_ = kNoSide;    ///< side along which the particle slides on the boundary
  int idleCrossings_ = 0;  ///< crossings in a row that took no time
  Index vertex_ = kNone;   ///< the last one that was left,
  Index vertexStep_ = 0;   ///< in this step
  TraceEnd end_;
};

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
  // Faces that hand a particle back and forth disagree by round-off only: it then goes along their edge a little.
  const bool undecided = idleCrossings_ > 3;
  if (undecided) h = std::min(h, 1e-3 * std::abs(side(0)) / std::abs(k1));
  for (int i = 0; i < 3 && !undecided; ++i) {
    const int across = (i + 1) % 3;
    if (b[i] <= kSlack && b[i] + rate[i] * h < -kSlack && across != slide_) {
      ++idleCrossings_;
      return cross(across, fractionAlong(across, position_));
    }
  }
  if (h == std::numeric_limits<double>::infinity()) return stop(StopReason::MinSpeed);  // at rest for ever
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
    const double way = h * std::max(speed1, speed5);
    // Near a fixed point the way is short: the error has to shrink with it for the trace to converge.
    const double allowed = std::min(tolerance_, kRelativeError * way);
    const double growth = std::clamp(0.9 * std::sqrt(std::sqrt(allowed / std::max(error, 1e-3 * allowed))), 0.1, 4.0);
    if (error <= allowed || way < 1e-3 * tolerance_) {
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
      // Along the edge at first: a path that then turns outwards belongs to the other face from the start.
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
    // The flow turns inwards within the step: leave the boundary where it does.
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

#include "tracing/detail/integrator_vertices.h"
