// Steps through faces of particles in a flow that changes, as many as a register has lanes, each in a face of its own.
// A lane's result does not depend on the others, nor on their number, nor on the processor.
//
// In barycentric coordinates the field of a face is A(t) b + c(b, t): A is linear in time, and c, the correction for
// curvature (tracing/flat_faces.h), is as small as the twist of the corners. The path is a Taylor series in time,
//     (k + 1) x_{k+1} = J x_k + K x_{k-1} + terms of w and c,   J = dA/db, K = dJ/dt, w = dA/dt at the start,
// with c as the parabola through its values at three points along the path of second order (Gauss' points, so that the
// integral of c is exact to the fifth order). Time is counted in units of the straight way through the face, so that no
// scale of mesh or field leaves single precision. Where the estimated error exceeds the tolerance, or the path is not
// plain (near a vertex, touching an edge), there is no step: the caller integrates in smaller ones.
//
// A template on the width of a register alone, as detail/lanes.h is, and under the same rule.
#pragma once

#include "tracing/detail/lanes.h"
#include "tracing/detail/small_rotation.h"

namespace stormfield::lanes {

/// Eight particles side by side. Coordinates are the barycentric ones of corners 1 and 2, and rates are of these.
struct alignas(64) UnsteadyParticles {
  static constexpr int kCount = 8;
  /// Where the step ends, unless at a corner's opposite side; kNoStep: nowhere, integrate in smaller ones.
  enum : int { kInside = -1, kNoStep = -2 };

  double rate[3][2][kCount];    ///< of the corners' carried vectors, 1/s
  double change[3][2][kCount];  ///< of these, 1/s^2
  double start[2][kCount];
  double entry[kCount];                              ///< the corner opposite to the side of entry, -1 inside
  double maxDuration[kCount];                        ///< of the step, seconds, above 0
  float tanHalf[3][kCount], doubleTwist[3][kCount];  ///< as in FlatFace
  float foot[kCount], height[kCount];                ///< of corner 2 over the base, in bases
  float allowed[kCount];                             ///< estimated error, as a fraction of the longest side

  double exit[kCount];  ///< the corner opposite to the side of exit, or one of the above
  double end[2][kCount];
  double duration[kCount];  ///< seconds; maxDuration itself where the step ends by it
};

template <int Bytes>
class UnsteadyStepKernel {
  using L = Lanes<Bytes>;
  using F = typename L::Floats;
  using D = typename L::Doubles;
  struct Pair {
    D x, y;
  };
  struct FloatPair {
    F x, y;
  };

  static constexpr int kOrder = 6, kPasses = 2;
  static constexpr double kPlain = 1e-6;  ///< barycentric distance from a vertex below which a path is not plain
  static constexpr double kReach = 2.0;   ///< longest step, in straight ways through the face
  static constexpr float kNever = 1e30F;  ///< longer than any time
  static constexpr float kPoint[3] = {0.112701665F, 0.5F, 0.887298335F};  ///< Gauss' points on [0, 1]
  static constexpr float kBetween = 0.774596669F;                         ///< from the first to the last
  /// Error of the parabola through the correction per quadratic part, for nearness n to a corner: min(kParabola n,
  /// kMaxParabola), and of its points, which lie beside the path, per square of the correction; relative round-off of the
  /// correction. Fitted to measured errors (test_arrivals.cpp), without unit.
  static constexpr float kParabola = 0.02F, kMaxParabola = 0.1F, kDisplaced = 1.0F, kRounding = 1e-6F;

 public:
  static void step(UnsteadyParticles& particles) {
    for (int first = 0; first < UnsteadyParticles::kCount; first += L::kCount) {
      UnsteadyStepKernel(particles, first).run(particles, first);
    }
  }

 private:
  UnsteadyStepKernel(const UnsteadyParticles& p, int first) {
    for (int i = 0; i < 3; ++i) {
      rate_[i] = {L::load(p.rate[i][0] + first), L::load(p.rate[i][1] + first)};
      change_[i] = {L::load(p.change[i][0] + first), L::load(p.change[i][1] + first)};
      __builtin_memcpy(&tanHalf_[i], p.tanHalf[i] + first, sizeof(F));
      __builtin_memcpy(&doubleTwist_[i], p.doubleTwist[i] + first, sizeof(F));
    }
    __builtin_memcpy(&foot_, p.foot + first, sizeof(F));
    __builtin_memcpy(&height_, p.height + first, sizeof(F));
    __builtin_memcpy(&allowed_, p.allowed + first, sizeof(F));
    const D x = L::load(p.start[0] + first), y = L::load(p.start[1] + first);
    start_[0] = 1.0 - x - y;
    start_[1] = x;
    start_[2] = y;
    const D entry = L::load(p.entry + first);
    for (int i = 0; i < 3; ++i) entered_[i] = entry == L::all(static_cast<double>(i));
    maxSeconds_ = L::load(p.maxDuration + first);
  }

  STORMFIELD_LANES_INLINE void run(UnsteadyParticles& particles, int first);
  STORMFIELD_LANES_INLINE Pair chooseUnit();
  STORMFIELD_LANES_INLINE void prepareCorrection();
  STORMFIELD_LANES_INLINE FloatPair correction(const FloatPair& p) const;
  STORMFIELD_LANES_INLINE void fitCorrection(const Pair& v);
  STORMFIELD_LANES_INLINE void expand(const Pair& v);
  STORMFIELD_LANES_INLINE void meetSides();
  STORMFIELD_LANES_INLINE void settle();

  /// Of a linear function of the barycentric coordinates with these values at the corners, along a vector.
  STORMFIELD_LANES_INLINE static Pair along(const Pair* corner, const Pair& v) {
    return {(corner[1].x - corner[0].x) * v.x + (corner[2].x - corner[0].x) * v.y,
            (corner[1].y - corner[0].y) * v.x + (corner[2].y - corner[0].y) * v.y};
  }
  STORMFIELD_LANES_INLINE static FloatPair toFloatPair(const Pair& p) { return {toFloats(p.x), toFloats(p.y)}; }
  STORMFIELD_LANES_INLINE static F sum(const FloatPair& p) { return absolute(p.x) + absolute(p.y); }

  Pair rate_[3], change_[3], series_[kOrder + 1];
  D start_[3], maxSeconds_, unit_, farthest_, duration_, leaving_;
  decltype(D() == D()) entered_[3];
  F tanHalf_[3], doubleTwist_[3], foot_, height_, allowed_, sides_[3], correctionError_;
  FloatPair floatRate_[3], rotated_[3], correction_[3];  ///< correction_: coefficients in time
};

/// Scales time so that the straight way through the face, or the longest step before, takes 1. The velocity at the
/// start of the affine part.
template <int Bytes>
auto UnsteadyStepKernel<Bytes>::chooseUnit() -> Pair {
  Pair v = {start_[0] * rate_[0].x + start_[1] * rate_[1].x + start_[2] * rate_[2].x,
            start_[0] * rate_[0].y + start_[1] * rate_[1].y + start_[2] * rate_[2].y};
  const D rates[3] = {-v.x - v.y, v.x, v.y};
  unit_ = maxSeconds_;
  for (int i = 0; i < 3; ++i) {
    const auto ahead = (rates[i] < 0.0) & (start_[i] > 0.0) & negated(entered_[i]);
    unit_ = select(ahead, smaller(unit_, -start_[i] / rates[i]), unit_);
  }
  const D square = unit_ * unit_;
  for (int i = 0; i < 3; ++i) {
    rate_[i] = {rate_[i].x * unit_, rate_[i].y * unit_};
    change_[i] = {change_[i].x * square, change_[i].y * square};
  }
  farthest_ = smaller(maxSeconds_ / unit_, L::all(kReach));
  return {v.x * unit_, v.y * unit_};
}

/// The corners' rates half way, also turned by a right angle, and the lengths of the sides.
template <int Bytes>
void UnsteadyStepKernel<Bytes>::prepareCorrection() {
  const F opposite = 1.0F - foot_, squaredHeight = height_ * height_, inverse = 1.0F / height_;
  sides_[0] = L::all(1.0F);
  sides_[1] = squareRoot(opposite * opposite + squaredHeight);
  sides_[2] = squareRoot(foot_ * foot_ + squaredHeight);
  for (int i = 0; i < 3; ++i) {
    const FloatPair r = toFloatPair({rate_[i].x + 0.5 * change_[i].x, rate_[i].y + 0.5 * change_[i].y});
    const F x = r.x + r.y * foot_, y = r.y * height_;
    floatRate_[i] = r;
    rotated_[i].y = x * inverse;
    rotated_[i].x = -y - rotated_[i].y * foot_;
  }
}

/// The field less its affine part.
template <int Bytes>
auto UnsteadyStepKernel<Bytes>::correction(const FloatPair& p) const -> FloatPair {
  const F b[3] = {1.0F - p.x - p.y, p.x, p.y};
  FloatPair total = {L::all(0.0F), L::all(0.0F)};
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3, previous = (i + 2) % 3;
    // Of the line from the corner, in the frame of its bisector.
    const F alongNext = b[next] * sides_[i], alongPrevious = b[previous] * sides_[previous];
    const F x = alongNext + alongPrevious, y = tanHalf_[i] * (alongPrevious - alongNext);
    const F t = y / larger(x + squareRoot(x * x + y * y), L::all(1e-30F));
    const F bounded = smaller(larger(t, L::all(-kMaxTangent)), L::all(kMaxTangent));
    const auto [cosineLess1, sine] = smallRotation(F(doubleTwist_[i] * arcTangent(bounded)));
    total.x = total.x + b[i] * (floatRate_[i].x * cosineLess1 + rotated_[i].x * sine);
    total.y = total.y + b[i] * (floatRate_[i].y * cosineLess1 + rotated_[i].y * sine);
  }
  return total;
}

template <int Bytes>
void UnsteadyStepKernel<Bytes>::fitCorrection(const Pair& v) {
  const FloatPair from = {toFloats(start_[1]), toFloats(start_[2])}, velocity = toFloatPair(v);
  const Pair turn = along(rate_, v);
  const FloatPair half = {0.5F * toFloats(turn.x), 0.5F * toFloats(turn.y)};
  const F zero = L::all(0.0F), one = L::all(1.0F);
  FloatPair at[3];
  for (int k = 0; k < 3; ++k) {
    const F t = L::all(kPoint[k]);
    at[k] = correction({smaller(larger(from.x + t * (velocity.x + t * half.x), zero), one),
                        smaller(larger(from.y + t * (velocity.y + t * half.y), zero), one)});
  }
  constexpr float kSlope = 1.0F / kBetween, kSquare = 2.0F / (kBetween * kBetween);
  const FloatPair slope = {kSlope * (at[2].x - at[0].x), kSlope * (at[2].y - at[0].y)};
  const FloatPair square = {kSquare * (at[0].x + at[2].x - 2.0F * at[1].x),
                            kSquare * (at[0].y + at[2].y - 2.0F * at[1].y)};
  correction_[0] = {at[1].x - 0.5F * slope.x + 0.25F * square.x, at[1].y - 0.5F * slope.y + 0.25F * square.y};
  correction_[1] = {slope.x - square.x, slope.y - square.y};
  correction_[2] = square;
  // How many times nearer to a corner the path begins or ends than it is long.
  const F dx = absolute(velocity.x), dy = absolute(velocity.y),
          length = larger(larger(dx, dy), absolute(velocity.x + velocity.y));
  const auto distance = [](const FloatPair& p) { return 1.0F - larger(larger(p.x, p.y), 1.0F - p.x - p.y); };
  const F nearest = smaller(distance(from), distance({from.x + velocity.x, from.y + velocity.y}));
  const F nearness = length / larger(nearest, L::all(1e-6F));
  const F size = sum(at[1]) + sum(slope);
  correctionError_ = smaller(kParabola * nearness, L::all(kMaxParabola)) * sum(square) +
                     kDisplaced * size * size * (1.0F + 0.2F * nearness) + kRounding * size;
}

template <int Bytes>
void UnsteadyStepKernel<Bytes>::expand(const Pair& v) {
  const Pair w = {start_[0] * change_[0].x + start_[1] * change_[1].x + start_[2] * change_[2].x,
                  start_[0] * change_[0].y + start_[1] * change_[1].y + start_[2] * change_[2].y};
  series_[0] = {start_[1], start_[2]};
  series_[1] = {v.x + toDoubles(correction_[0].x), v.y + toDoubles(correction_[0].y)};
  Pair next = along(rate_, series_[1]);
  series_[2] = {0.5 * (next.x + w.x + toDoubles(correction_[1].x)), 0.5 * (next.y + w.y + toDoubles(correction_[1].y))};
  for (int k = 3; k <= kOrder; ++k) {
    next = along(rate_, series_[k - 1]);
    const Pair late = along(change_, series_[k - 2]);
    next = {next.x + late.x, next.y + late.y};
    if (k == 3) next = {next.x + toDoubles(correction_[2].x), next.y + toDoubles(correction_[2].y)};
    series_[k] = {(1.0 / k) * next.x, (1.0 / k) * next.y};
  }
}

/// Which side the path of second order meets first, and when; no farther than the step may go.
template <int Bytes>
void UnsteadyStepKernel<Bytes>::meetSides() {
  const FloatPair v = toFloatPair(series_[1]), a = toFloatPair(series_[2]);
  const F b[3] = {toFloats(start_[0]), toFloats(start_[1]), toFloats(start_[2])};
  const F slope[3] = {-v.x - v.y, v.x, v.y}, square[3] = {-a.x - a.y, a.x, a.y};
  D t = L::all(static_cast<double>(kNever));
  leaving_ = L::all(static_cast<double>(UnsteadyParticles::kInside));
  for (int i = 0; i < 3; ++i) {
    const F q = squareRoot(larger(slope[i] * slope[i] - 4.0F * square[i] * b[i], L::all(0.0F))) - slope[i];
    const D met = toDoubles(select(q > 0.0F, 2.0F * b[i] / q, L::all(kNever)));
    const auto sooner = (met < t) & negated(entered_[i]);
    t = select(sooner, met, t);
    leaving_ = select(sooner, L::all(static_cast<double>(i)), leaving_);
  }
  const auto across = t <= farthest_;
  duration_ = select(across, t, farthest_);
  leaving_ = select(across, leaving_, L::all(static_cast<double>(UnsteadyParticles::kInside)));
}

/// Newton's iteration to the side of exit.
template <int Bytes>
void UnsteadyStepKernel<Bytes>::settle() {
  D c[kOrder + 1];
  const auto third = leaving_ == L::all(0.0), first = leaving_ == L::all(1.0);
  c[0] = select(third, start_[0], select(first, start_[1], start_[2]));
  for (int k = 1; k <= kOrder; ++k) {
    c[k] = select(third, -series_[k].x - series_[k].y, select(first, series_[k].x, series_[k].y));
  }
  const auto moving = leaving_ >= 0.0;
  for (int pass = 0; pass < kPasses; ++pass) {
    D value = c[kOrder], slope = static_cast<double>(kOrder) * c[kOrder];
    for (int k = kOrder; k-- > 0;) {
      value = value * duration_ + c[k];
      if (k > 0) slope = slope * duration_ + static_cast<double>(k) * c[k];
    }
    duration_ = select(moving & (slope < 0.0), duration_ - value / slope, duration_);
  }
}

template <int Bytes>
void UnsteadyStepKernel<Bytes>::run(UnsteadyParticles& particles, int firstParticle) {
  const Pair v = chooseUnit();
  prepareCorrection();
  fitCorrection(v);
  expand(v);
  meetSides();
  settle();

  Pair end = series_[kOrder], last = {static_cast<double>(kOrder) * end.x, static_cast<double>(kOrder) * end.y};
  for (int k = kOrder; k-- > 0;) {
    end = {end.x * duration_ + series_[k].x, end.y * duration_ + series_[k].y};
    if (k == 0) break;
    last = {last.x * duration_ + static_cast<double>(k) * series_[k].x,
            last.y * duration_ + static_cast<double>(k) * series_[k].y};
  }
  const D ends[3] = {1.0 - end.x - end.y, end.x, end.y};
  const D startRates[3] = {-series_[1].x - series_[1].y, series_[1].x, series_[1].y};
  const D lastRates[3] = {-last.x - last.y, last.x, last.y};
  auto plain = (duration_ > 0.0) & (duration_ <= farthest_);
  for (int i = 0; i < 3; ++i) {
    const auto mine = leaving_ == L::all(static_cast<double>(i));
    // On the side itself, going out, unless another side is left.
    plain = plain & (negated(mine) | ((absolute(ends[i]) <= 1e-12) & (lastRates[i] < 0.0)));
    plain = plain & (mine | (ends[i] > kPlain));
    // Inside at the start, or going in.
    plain = plain & (negated(entered_[i]) | (startRates[i] > 0.0)) & (entered_[i] | (start_[i] > 0.0));
    // And in between, by the directions at the ends.
    const D low = smaller(start_[i] + 0.5 * duration_ * startRates[i], ends[i] - 0.5 * duration_ * lastRates[i]);
    plain = plain & (mine | (startRates[i] >= 0.0) | (lastRates[i] <= 0.0) | (low > 0.0));
  }

  const F time = toFloats(duration_), square = time * time;
  const F remainder = sum(toFloatPair(series_[kOrder])) * (square * square * square);
  const auto exact = toDoubles(remainder + time * correctionError_) <= toDoubles(allowed_);
  const auto whole = (leaving_ < 0.0) & (duration_ * unit_ >= maxSeconds_ * (1.0 - 1e-15));
  L::store(select(plain & exact, leaving_, L::all(static_cast<double>(UnsteadyParticles::kNoStep))),
           particles.exit + firstParticle);
  L::store(end.x, particles.end[0] + firstParticle);
  L::store(end.y, particles.end[1] + firstParticle);
  L::store(select(whole, maxSeconds_, smaller(duration_ * unit_, maxSeconds_)), particles.duration + firstParticle);
}

using UnsteadyStep = void (*)(UnsteadyParticles&);
/// The fastest for this processor; all give the same bits.
UnsteadyStep unsteadyStep();
/// As compiled for processors with AVX2; where STORMFIELD_AVX2 is defined only.
UnsteadyStep unsteadyStepForAvx2();

}  // namespace stormfield::lanes
