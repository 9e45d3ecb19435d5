// The two kinds of flow the integrator follows, with one interface: a cursor in time, the vectors of the current
// face, and the velocity at a point of it. The sign of the direction and a constant speed factor belong to the flow.
#pragma once

#include <algorithm>
#include <limits>

#include "field/vector_field.h"
#include "tracing/detail/lambda_track.h"
#include "tracing/face_flow.h"
#include "tracing/flat_faces.h"
#include "tracing/trace.h"

namespace stormfield {

class SteadyFlow {
 public:
  static constexpr bool kSteady = true;
  struct Cursor {};
  using Local = CarriedVectors;

  /// prepared: the FaceFlow of each face and rate * values, computed before many traces; null: computed on entry.
  SteadyFlow(const Complex* values, double rate, const FaceFlow* prepared = nullptr)
      : values_(values), rate_(rate), prepared_(prepared) {}

  Cursor start(double) const { return {}; }
  /// Time left until the cursor has to advance.
  double remaining(Cursor, double) const { return std::numeric_limits<double>::infinity(); }
  double segmentDuration(Cursor) const { return std::numeric_limits<double>::infinity(); }
  void advance(Cursor&) const {}

  Local enter(const FlatFace& face, Cursor) const {
    return face.carry(rate_ * values_[face.vertex(0)], rate_ * values_[face.vertex(1)],
                      rate_ * values_[face.vertex(2)]);
  }
  std::array<Complex, 3> vertexValues(const FlatFace& face) const {
    return {rate_ * values_[face.vertex(0)], rate_ * values_[face.vertex(1)], rate_ * values_[face.vertex(2)]};
  }
  const FaceFlow* prepared(Index f) const { return prepared_ == nullptr ? nullptr : prepared_ + f; }
  /// Loads a face that will be entered soon into the cache.
  void prefetch(Index f) const {
#ifdef __GNUC__
    if (prepared_ == nullptr) return;
    __builtin_prefetch(prepared_ + f);
    __builtin_prefetch(reinterpret_cast<const char*>(prepared_ + f) + sizeof(FaceFlow) / 2);
#else
    static_cast<void>(f);
#endif
  }
  Complex velocity(const FlatFace& face, const Local& u, Cursor, Complex p, double) const {
    return face.evaluate(u, p);
  }
  Complex vertexVelocity(Index v, Cursor, double) const {
    return rate_ * values_[v];
  }

 private:
  const Complex* values_;
  double rate_;
  const FaceFlow* prepared_;
};

/// Times are physical seconds; a negative rate runs backward in time.
class UnsteadyFlow {
 public:
  static constexpr bool kSteady = false;
  using Cursor = std::size_t;  ///< index of the time segment
  struct Local {
    CarriedVectors base, change;  ///< at theta = 0, and from there to theta = 1
  };

  UnsteadyFlow(const ParameterizedField& field, const std::vector<TimeSegment>& segments, Direction direction,
               double speed)
      : field_(&field),
        segments_(&segments),
        backward_(direction == Direction::Backward),
        rate_(backward_ ? -speed : speed) {}

  Cursor start(double t) const {
    const auto& s = *segments_;
    const auto after = [&](double time, const TimeSegment& segment) { return time < segment.begin; };
    const auto it = std::upper_bound(s.begin() + 1, s.end(), t, after) - 1;
    const auto i = static_cast<Cursor>(it - s.begin());
    return backward_ && i > 0 && s[i].begin == t ? i - 1 : i;
  }
  double remaining(Cursor i, double t) const { return backward_ ? t - (*segments_)[i].begin : (*segments_)[i].end - t; }
  double segmentDuration(Cursor i) const { return (*segments_)[i].end - (*segments_)[i].begin; }
  void advance(Cursor& i) const { i = backward_ ? i - 1 : i + 1; }

  Local enter(const FlatFace& face, Cursor i) const {
    const Complex* a = field_->sample((*segments_)[i].sample);
    const Complex* b = upperSample(i);
    const auto change = [&](int corner) { return rate_ * (b[face.vertex(corner)] - a[face.vertex(corner)]); };
    const auto base = [&](int corner) { return rate_ * a[face.vertex(corner)]; };
    return {face.carry(base(0), base(1), base(2)), face.carry(change(0), change(1), change(2))};
  }
  Complex velocity(const FlatFace& face, const Local& u, Cursor i, Complex p, double t) const {
    return face.evaluate(u.base.plus((*segments_)[i].theta(t), u.change), p);
  }
  Complex vertexVelocity(Index v, Cursor i, double t) const {
    const double theta = (*segments_)[i].theta(t);
    const Complex a = field_->sample((*segments_)[i].sample)[v];
    return rate_ * (a + theta * (upperSample(i)[v] - a));
  }

 private:
  const Complex* upperSample(Cursor i) const {
    return field_->sample(std::min((*segments_)[i].sample + 1, field_->sampleCount() - 1));
  }

  const ParameterizedField* field_;
  const std::vector<TimeSegment>* segments_;
  bool backward_;
  double rate_;
};

}  // namespace stormfield
