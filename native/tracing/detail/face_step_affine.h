// The path of the affine part of the field through a face: its Taylor series, and where it leaves the face.
#pragma once

#include "tracing/detail/face_step_kernel.h"

namespace stormfield::lanes {

template <int Bytes, int Count, bool Curved>
void FaceStepKernel<Bytes, Count, Curved>::gatherShape() {
  floatFoot_ = toFloats(foot_);
  floatHeight_ = toFloats(height_);
  if constexpr (Curved) {
    const F opposite = 1.0F - floatFoot_, squaredHeight = floatHeight_ * floatHeight_, inverse = 1.0F / floatHeight_;
    sides_[0] = L::all(1.0F);
    sides_[1] = squareRoot(opposite * opposite + squaredHeight);
    sides_[2] = squareRoot(floatFoot_ * floatFoot_ + squaredHeight);
    for (int i = 0; i < 3; ++i) {
      const FloatPair r = floatRate_[i] = toFloatPair(rate_[i]);
      const F x = r.x + r.y * floatFoot_, y = r.y * floatHeight_;
      rotated_[i].y = x * inverse;
      rotated_[i].x = -y - rotated_[i].y * floatFoot_;
    }
  }
  for (int i = 0; i < 2; ++i) {
    along_[i] = {rate_[i + 1].x - rate_[0].x, rate_[i + 1].y - rate_[0].y};
    floatAlong_[i] = toFloatPair(along_[i]);
  }
  const F x = absolute(floatAlong_[0].x) + absolute(floatAlong_[1].x);
  const F y = absolute(floatAlong_[0].y) + absolute(floatAlong_[1].y);
  stretch_ = larger(x, y);
}

/// The series of the affine part, with the correction near the middle of the path as a constant.
template <int Bytes, int Count, bool Curved>
void FaceStepKernel<Bytes, Count, Curved>::followAffinePart() {
  const Pair added = jacobian(start_);
  Pair r = {rate_[0].x + added.x, rate_[0].y + added.y};
  if constexpr (Curved) {
    constant_ = correctionNearMiddle(toFloatPair(r));
    r.x = r.x + toDoubles(constant_.x);
    r.y = r.y + toDoubles(constant_.y);
  }
  series_[0] = start_;
  series_[1] = r;
  for (int k = 2; k <= kOrder; ++k) {
    const Pair next = jacobian(series_[k - 1]);
    series_[k] = {(1.0 / k) * next.x, (1.0 / k) * next.y};
  }
  for (int k = 0; k <= kOrder; ++k) floatSeries_[k] = toFloatPair(series_[k]);
}

template <int Bytes, int Count, bool Curved>
auto FaceStepKernel<Bytes, Count, Curved>::at(const D& t) const -> Pair {
  Pair p = series_[kOrder];
  for (int k = kOrder; k-- > 0;) p = {p.x * t + series_[k].x, p.y * t + series_[k].y};
  return p;
}

/// Which side the path of second order meets first, and when; no farther than the series reaches.
template <int Bytes, int Count, bool Curved>
void FaceStepKernel<Bytes, Count, Curved>::meetSides() {
  const FloatPair* s = floatSeries_;
  const F b[3] = {third(s[0]), s[0].x, s[0].y}, v[3] = {rateOfThird(s[1]), s[1].x, s[1].y};
  const F a[3] = {rateOfThird(s[2]), s[2].x, s[2].y};
  D t = L::all(static_cast<double>(kNever));
  leaving_ = L::all(-1.0);
  for (int i = 0; i < 3; ++i) {
    const F q = squareRoot(larger(v[i] * v[i] - 4.0F * a[i] * b[i], L::all(0.0F))) - v[i];
    const D met = toDoubles(select(q > 0.0F, 2.0F * b[i] / q, L::all(kNever)));
    const auto sooner = (met < t) & negated(entered_[i]);
    t = select(sooner, met, t);
    leaving_ = select(sooner, L::all(static_cast<double>(i)), leaving_);
  }
  // Where the terms left out, about half of the last one, are a quarter of the tolerance.
  const F last = 0.5F * size_ * (toFloats(absolute(series_[kOrder].x) + absolute(series_[kOrder].y)));
  // The twelfth root, nearly.
  const F power = smaller(0.25F * tolerance_ / larger(last, L::all(1e-37F)), L::all(1e30F));
  const F sixteenth = squareRoot(squareRoot(squareRoot(squareRoot(power))));
  const F reach = sixteenth * squareRoot(squareRoot(sixteenth));
  const D farthest = smaller(toDoubles(reach), maxTime_);
  const auto across = t <= farthest;
  duration_ = select(across, t, farthest);
  leaving_ = select(across, leaving_, L::all(-1.0));
}

/// Newton's iteration to the side of exit, or to another side that the path meets before.
template <int Bytes, int Count, bool Curved>
void FaceStepKernel<Bytes, Count, Curved>::settle() {
  const D none = L::all(-1.0);
  end_ = at(duration_);
  settled_ = leaving_ == none;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const D b[3] = {third(end_), end_.x, end_.y};
    const Pair added = jacobian(Pair{end_.x - start_.x, end_.y - start_.y});
    const Pair v = {series_[1].x + added.x, series_[1].y + added.y};
    const D rates[3] = {-v.x - v.y, v.x, v.y};
    D value = L::all(0.0), slope = L::all(-1.0);
    // The side whose coordinate is most negative; small ones are round-off, or what the end of the step corrects.
    for (int i = 0; i < 3; ++i) {
      const auto mine = leaving_ == L::all(static_cast<double>(i));
      value = select(mine, b[i], value);
      slope = select(mine, rates[i], slope);
    }
    for (int i = 0; i < 3; ++i) {
      const auto before =
          negated(settled_) & negated(entered_[i]) & (b[i] < smaller(value, L::all(-1e-3))) & (rates[i] < 0.0);
      leaving_ = select(before, L::all(static_cast<double>(i)), leaving_);
      value = select(before, b[i], value);
      slope = select(before, rates[i], slope);
    }
    const D change = value / slope;
    settled_ = settled_ | (absolute(change) <= 0.003 * duration_);
    const auto moving = negated(settled_);
    if (!isAny(moving)) break;
    duration_ = select(moving, duration_ - change, duration_);
    end_ = at(duration_);
  }
}

/// Where the path of the affine part is at the points of Gauss' rule.
template <int Bytes, int Count, bool Curved>
void FaceStepKernel<Bytes, Count, Curved>::placeNodes() {
  const F duration = toFloats(duration_);
  for (int i = 0; i < kNodes; ++i) {
    const F t = duration * kPoint[i];
    FloatPair p = floatSeries_[kOrder];
    for (int k = kOrder; k-- > 0;) p = {p.x * t + floatSeries_[k].x, p.y * t + floatSeries_[k].y};
    node_[i] = p;
  }
}

}  // namespace stormfield::lanes
