// The class of tracing/integrator.h, which users include; its longer members are defined in integrator_steps.h and
// integrator_vertices.h.
#pragma once

#include <array>
#include <numbers>
#include <type_traits>

#include "tracing/detail/face_steps.h"
#include "tracing/flow.h"
#include "tracing/trace.h"

namespace stormfield {

template <typename Flow>
class Integrator {
 public:
  /// The options' direction only says how physical time runs; the flow's velocities already point in it.
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

  // The same step by step, for steps that are computed elsewhere. begin and take return whether the trace goes on.

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
  /// Sets the next step through the current face; false where it has no closed form.
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
  /// Written number by number: a vector operation would wait for the numbers stored one by one before.
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
  /// After a step: the side by which the current face was entered, if the step ended there.
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
  /// A step is tried up to this factor beyond the straight exit, so that curved paths leave in one step as well.
  static constexpr double kOvershoot = 1.1;
  /// Largest error of a step as a fraction of its length, whatever the tolerance.
  static constexpr double kRelativeError = 0.02;
  /// The same of a step in closed form, which may go around a fixed point.
  static constexpr double kRelativeStepError = 1e-4;

  /// Tolerances below this, in mean edges, are finer than the errors of steps in closed form.
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
  /// Carries the vectors of the current face into its frame; needed before its velocities.
  void load() {
    if (loaded_) return;
    local_ = flow_.enter(*flat_, cursor_);
    loaded_ = true;
  }

  Complex side(int i) const { return flat_->corner((i + 1) % 3) - flat_->corner(i); }

  Complex velocity(Complex p, double elapsed) const {
    return flow_.velocity(*flat_, local_, cursor_, p, startTime_ + timeSign_ * elapsed);
  }
  /// The velocity that is followed: along a boundary, its tangential component.
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
  /// A seed on a side enters the face that the flow leads into, if there is one.
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
  typename Flow::Local local_{};
  bool loaded_ = false;
  SidePoint entry_;         ///< where the particle entered the face, as long as it is there
  bool positioned_ = true;  ///< else it is at the entry, or at inside_
  Eigen::Vector3d inside_ =
      Eigen::Vector3d::Zero();  ///< barycentric coordinates after a step in closed form that ends inside
  FaceFlow faceFlow_{};         ///< of the face faceOfFlow_
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

}  // namespace stormfield
