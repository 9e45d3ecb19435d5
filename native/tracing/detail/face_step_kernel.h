// The steps of tracing/face_path.h for as many particles as a register has lanes, each in a face of its own. A lane's
// result does not depend on the others, nor on their number.
//
// A template on the width of a register alone, as tracing/lanes.h is, and under the same rule.
#pragma once

#include "tracing/detail/lanes.h"
#include "tracing/face_flow.h"

namespace stormfield::lanes {

/// What becomes of a step.
enum : int { kInside = -1, kNotPlain = -2, kTooLong = -3 };

/// Particles side by side; unused ones need a face as well. Coordinates are the barycentric ones of corners 1 and 2.
template <int Count>
struct alignas(Count < 2 ? 8 : 64) ParticlesOf {
  const FaceFlow* face[Count];
  double start[2][Count];
  double entry[Count];    ///< the corner opposite to the side of entry, -1 inside
  double longest[Count];  ///< of the step, seconds

  double exit[Count];  ///< the corner opposite to the side of exit; kInside, kNotPlain; kTooLong: shorten to duration
  double end[2][Count];
  double duration[Count], length[Count];
};

/// As StepLimits, in mesh units.
struct KernelLimits {
  double tolerance, relativeTolerance, minSpeed;
};

/// Steps as many particles as there are lanes, from a first one. Unless Curved, what curvature adds to the affine part
/// counts as an error.
template <int Bytes, int Count, bool Curved>
class FaceStepKernel {
  using L = Lanes<Bytes>;
  using F = typename L::Floats;
  using D = typename L::Doubles;
  using Particles = ParticlesOf<Count>;
  struct FloatPair {
    F x, y;
  };
  struct Pair {
    D x, y;
  };

  static constexpr int kOrder = 12, kNodes = 4, kMoments = 7, kMostPasses = 4;
  static constexpr double kPlain = 1e-6;  ///< barycentric distance from a vertex below which a path is not plain
  static constexpr float kFar = 1e30F;    ///< longer than any time

  // Gauss' rule with four points on [0, 1]; integrals from 0 to each of them of the cubic through four values; that
  // cubic at 0 (and, reversed, at 1); its quadratic and cubic Legendre parts; integrals from 0 to the inner points of
  // the parabola through the outer values that vanishes in the middle, for the first value and then for the last.
  static constexpr float kPoint[kNodes] = {0.0694318442F, 0.330009478F, 0.669990522F, 0.930568156F};
  static constexpr float kWeight[kNodes] = {0.173927423F, 0.326072577F, 0.326072577F, 0.173927423F};
  static constexpr float kIntegral[kNodes][kNodes] = {{0.0869637113F, -0.0266041801F, 0.0126274627F, -0.00355514969F},
                                                      {0.188118117F, 0.163036289F, -0.0278804286F, 0.00673550059F},
                                                      {0.167191922F, 0.353953006F, 0.163036289F, -0.0141906949F},
                                                      {0.177482572F, 0.313445115F, 0.352676758F, 0.0869637113F}};
  static constexpr float kAtStart[kNodes] = {1.52678813F, -0.813632449F, 0.400761520F, -0.113917196F};
  static constexpr float kGuess[4] = {0.236339015F, 0.245171218F, -0.0204185039F, -0.0115863007F};
  static constexpr float kQuadratic[kNodes] = {0.532404142F, -0.532404142F, -0.532404142F, 0.532404142F};
  static constexpr float kCubic[kNodes] = {-0.371027003F, 0.939772470F, -0.939772470F, 0.371027003F};

 public:
  static constexpr int kLanes = L::kCount;

  static void step(Particles& particles, int first, const KernelLimits& limits) {
    FaceStepKernel(particles, first, limits).run(particles, first);
  }

 private:
  FaceStepKernel(const Particles& particles, int first, const KernelLimits& limits) {
    const auto face = [&](int lane) -> const FaceFlow& { return *particles.face[first + lane]; };
    const auto given = [&](const double* values) { return L::load(values + first); };
    const auto doubles = [&](const auto& get) { return L::doubles([&](int lane) { return get(face(lane)); }); };
    const auto floats = [&](const auto& get) { return L::floats([&](int lane) { return get(face(lane)); }); };
    for (int i = 0; i < 3; ++i) {
      rate_[i] = {doubles([i](const FaceFlow& f) { return f.rate[i][0]; }),
                  doubles([i](const FaceFlow& f) { return f.rate[i][1]; })};
      if constexpr (Curved) {
        tanHalf_[i] = floats([i](const FaceFlow& f) { return f.tanHalf[i]; });
        doubleTwist_[i] = floats([i](const FaceFlow& f) { return f.doubleTwist[i]; });
      }
    }
    foot_ = doubles([](const FaceFlow& f) { return f.foot; });
    height_ = doubles([](const FaceFlow& f) { return f.height; });
    base_ = doubles([](const FaceFlow& f) { return f.base; });
    unit_ = doubles([](const FaceFlow& f) { return f.unit; });
    size_ = floats([](const FaceFlow& f) { return f.longestSide; });
    if constexpr (!Curved) neglected_ = floats([](const FaceFlow& f) { return f.bend; });
    start_ = {given(particles.start[0]), given(particles.start[1])};
    const D entry = given(particles.entry);
    for (int i = 0; i < 3; ++i) entered_[i] = entry == L::all(static_cast<double>(i));
    longestSeconds_ = given(particles.longest);
    longest_ = longestSeconds_ / unit_;
    tolerance_ = toFloats(limits.tolerance / base_);
    relativeTolerance_ = L::all(static_cast<float>(limits.relativeTolerance));
    minSpeed_ = toFloats(limits.minSpeed * unit_ / base_);
  }

  void run(Particles& particles, int first);
  void gatherShape();
  void followAffinePart();
  void meetSides();
  void settle();
  FloatPair correctionNearMiddle(const FloatPair& rate) const;
  void placeNodes();
  F bend();
  /// At one point of each particle's face, or (Point wider than F) at several points of the one particle's face.
  template <typename Point>
  Point correction(const Point& p) const;
  template <int Points>
  void correctionsAt(const FloatPair* p, FloatPair* c) const;
  Pair at(const D& t) const;

  // Barycentric coordinates of all three corners.
  static D third(const Pair& p) { return 1.0 - p.x - p.y; }
  static F third(const FloatPair& p) { return 1.0F - p.x - p.y; }
  static F rateOfThird(const FloatPair& p) { return -p.x - p.y; }
  static FloatPair toFloatPair(const Pair& p) { return {toFloats(p.x), toFloats(p.y)}; }
  Pair jacobian(const Pair& v) const {
    return {v.x * along_[0].x + v.y * along_[1].x, v.x * along_[0].y + v.y * along_[1].y};
  }
  FloatPair jacobian(const FloatPair& v) const {
    return {v.x * floatAlong_[0].x + v.y * floatAlong_[1].x, v.x * floatAlong_[0].y + v.y * floatAlong_[1].y};
  }
  /// Length, in bases, of a change of the coordinates.
  F lengthOf(const FloatPair& v) const {
    const F x = v.x + v.y * floatFoot_, y = v.y * floatHeight_;
    return squareRoot(x * x + y * y);
  }

  // The face and its field.
  Pair rate_[3], along_[2];  ///< rates of the carried vectors; columns of the Jacobian
  D foot_, height_, base_, unit_;
  F size_, neglected_, floatFoot_, floatHeight_;
  FloatPair floatAlong_[2], floatRate_[3], turned_[3];  ///< turned: rates of the vectors turned by a right angle
  F sides_[3], tanHalf_[3], doubleTwist_[3];
  // The task.
  Pair start_;
  decltype(D() == D()) entered_[3];
  D longest_, longestSeconds_;
  F tolerance_, relativeTolerance_, minSpeed_;
  // The path of the affine part and a constant.
  FloatPair constant_ = {F(), F()};
  Pair series_[kOrder + 1];
  FloatPair floatSeries_[kOrder + 1];
  F stretch_;
  D duration_;
  D leaving_;  ///< the corner whose coordinate vanishes at the end; -1 where the step ends inside
  Pair end_;
  decltype(D() == D()) settled_;
  // What bends it.
  FloatPair node_[kNodes], bent_[kNodes] = {};
  FloatPair displacement_ = {F(), F()}, firstBent_ = displacement_, lastBent_ = displacement_;
};

template <int Bytes, int Count, bool Curved>
void FaceStepKernel<Bytes, Count, Curved>::gatherShape() {
  floatFoot_ = toFloats(foot_);
  floatHeight_ = toFloats(height_);
  if constexpr (Curved) {
    const F rest = 1.0F - floatFoot_, squaredHeight = floatHeight_ * floatHeight_, inverse = 1.0F / floatHeight_;
    sides_[0] = L::all(1.0F);
    sides_[1] = squareRoot(rest * rest + squaredHeight);
    sides_[2] = squareRoot(floatFoot_ * floatFoot_ + squaredHeight);
    for (int i = 0; i < 3; ++i) {
      const FloatPair r = floatRate_[i] = toFloatPair(rate_[i]);
      const F x = r.x + r.y * floatFoot_, y = r.y * floatHeight_;
      turned_[i].y = x * inverse;
      turned_[i].x = -y - turned_[i].y * floatFoot_;
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
  const Pair move = jacobian(start_);
  Pair r = {rate_[0].x + move.x, rate_[0].y + move.y};
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
  D t = L::all(static_cast<double>(kFar));
  leaving_ = L::all(-1.0);
  for (int i = 0; i < 3; ++i) {
    const F q = squareRoot(larger(v[i] * v[i] - 4.0F * a[i] * b[i], L::all(0.0F))) - v[i];
    const D met = toDoubles(select(q > 0.0F, 2.0F * b[i] / q, L::all(kFar)));
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
  const D farthest = smaller(toDoubles(reach), longest_);
  const auto across = t <= farthest;
  duration_ = select(across, t, farthest);
  leaving_ = select(across, leaving_, L::all(-1.0));
}

/// Newton's steps to the side that is left, and another side if it comes first.
template <int Bytes, int Count, bool Curved>
void FaceStepKernel<Bytes, Count, Curved>::settle() {
  const D none = L::all(-1.0);
  end_ = at(duration_);
  settled_ = leaving_ == none;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const D b[3] = {third(end_), end_.x, end_.y};
    const Pair turn = jacobian(Pair{end_.x - start_.x, end_.y - start_.y});
    const Pair v = {series_[1].x + turn.x, series_[1].y + turn.y};
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

template <int Bytes, int Count, bool Curved>
void FaceStepKernel<Bytes, Count, Curved>::run(Particles& particles, int firstParticle) {
  gatherShape();
  followAffinePart();
  meetSides();
  const D guess = duration_;
  settle();
  placeNodes();
  F error = L::all(0.0F);
  if constexpr (Curved) {
    error = bend();
  } else {
    error = neglected_ * toFloats(duration_);
  }

  // To the side itself.
  Pair end = {end_.x + toDoubles(displacement_.x), end_.y + toDoubles(displacement_.y)};
  const Pair turn = jacobian(Pair{end.x - start_.x, end.y - start_.y});
  const Pair v = {series_[1].x + turn.x + toDoubles(lastBent_.x), series_[1].y + turn.y + toDoubles(lastBent_.y)};
  const D ends[3] = {third(end), end.x, end.y}, rates[3] = {-v.x - v.y, v.x, v.y};
  // What is left out may not decide over which side the path comes or goes: faces beside each other have to agree.
  D margin = L::all(0.0);
  if constexpr (!Curved) margin = toDoubles(neglected_ * size_ / floatHeight_);
  D late = L::all(0.0);
  auto plain = settled_ & (unit_ > 0.0) & (duration_ > 0.0);
  for (int i = 0; i < 3; ++i) {
    const auto mine = leaving_ == L::all(static_cast<double>(i));
    late = select(mine, -ends[i] / rates[i], late);
    plain = plain & (negated(mine) | (rates[i] < -margin));
  }
  const Pair bending = jacobian(v);
  // Where the path meets the side, to second order.
  for (int i = 0; i < 3; ++i) {
    const D bendings[3] = {-bending.x - bending.y, bending.x, bending.y};
    const auto mine = leaving_ == L::all(static_cast<double>(i));
    late = select(mine, late - 0.5 * late * late * bendings[i] / rates[i], late);
  }
  const D halfSquare = 0.5 * late * late;
  end = {end.x + late * v.x + halfSquare * bending.x, end.y + late * v.y + halfSquare * bending.y};
  const D duration = duration_ + late;
  const F lateness = absolute(toFloats(late)), step = toFloats(duration);

  // Inside all along: the points of Gauss' rule, the directions at the ends, and where they allow a dip between.
  const FloatPair first = {floatSeries_[1].x + firstBent_.x, floatSeries_[1].y + firstBent_.y};
  const F starts[3] = {third(floatSeries_[0]), floatSeries_[0].x, floatSeries_[0].y};
  const F startRates[3] = {rateOfThird(first), first.x, first.y};
  const D last[3] = {third(end), end.x, end.y};
  F least = L::all(1.0F);
  for (int i = 0; i < kNodes; ++i) {
    least = smaller(least, smaller(smaller(node_[i].x, node_[i].y), third(node_[i])));
  }
  plain = plain & (toDoubles(least) > 0.0);
  for (int i = 0; i < 3; ++i) {
    const auto mine = leaving_ == L::all(static_cast<double>(i));
    const D rate0 = toDoubles(startRates[i]);
    plain = plain & (negated(entered_[i]) | (rate0 > margin));
    plain = plain & (mine | (last[i] > kPlain));
    const D low = smaller(toDoubles(starts[i]) + 0.5 * duration * rate0, last[i] - 0.5 * duration * rates[i]);
    plain = plain & (mine | (rate0 >= 0.0) | (rates[i] <= 0.0) | (low > 0.0));
  }
  const D starting[3] = {third(start_), start_.x, start_.y};
  // Else a shorter step may be plain.
  auto beginsPlain = (unit_ > 0.0) & (guess > 0.0);
  for (int i = 0; i < 3; ++i) {
    beginsPlain = beginsPlain & (entered_[i] | (starting[i] > kPlain)) &
                  (negated(entered_[i]) | (toDoubles(startRates[i]) > margin));
  }
  plain = plain & beginsPlain;

  // Length: of the chord, and by how much the path exceeds it.
  const Pair change = {end.x - start_.x, end.y - start_.y};
  const D chordX = change.x + change.y * foot_, chordY = change.y * height_;
  const D chord = squareRoot(chordX * chordX + chordY * chordY);
  const F ux = toFloats(chordX / chord), uy = toFloats(chordY / chord);
  F excess = L::all(0.0F), excessQuadratic = excess, excessCubic = excess, slowest = L::all(kFar),
    backwards = L::all(1.0F), sideways = L::all(0.0F);
  for (int i = 0; i < kNodes; ++i) {
    const FloatPair fromStart = {node_[i].x - floatSeries_[0].x, node_[i].y - floatSeries_[0].y};
    const FloatPair w = jacobian(fromStart);
    const FloatPair r = {floatSeries_[1].x + w.x + bent_[i].x, floatSeries_[1].y + w.y + bent_[i].y};
    const F x = r.x + r.y * floatFoot_, y = r.y * floatHeight_;
    const F forward = x * ux + y * uy, aside = y * ux - x * uy, speed = squareRoot(x * x + y * y);
    const F more = aside * aside / (speed + forward);
    slowest = smaller(slowest, speed);
    backwards = smaller(backwards, forward);
    sideways = larger(sideways, absolute(aside));
    excess = excess + kWeight[i] * more;
    excessQuadratic = excessQuadratic + kQuadratic[i] * more;
    excessCubic = excessCubic + kCubic[i] * more;
  }
  plain = plain & (toDoubles(backwards) > 0.0) & (toDoubles(slowest - minSpeed_) > 0.0);
  const FloatPair lastRate = toFloatPair(v);
  const F lastX = lastRate.x + lastRate.y * floatFoot_, lastY = lastRate.y * floatHeight_;
  const F lastForward = lastX * ux + lastY * uy, lastAside = lastY * ux - lastX * uy;
  const F lastExcess = lastAside * lastAside / (squareRoot(lastX * lastX + lastY * lastY) + lastForward);
  const D length = chord + toDoubles(toFloats(duration_) * excess + toFloats(late) * lastExcess);

  // The error: of the series, the bend, the last way to the side, the length.
  const F squaredTime = step * step, fourth = squaredTime * squaredTime;
  error = error + smaller((1.0F / 13) * stretch_ * step, L::all(0.5F)) * size_ * (fourth * fourth * fourth) *
                      toFloats(absolute(series_[kOrder].x) + absolute(series_[kOrder].y));
  const FloatPair jump = {lastBent_.x - bent_[kNodes - 1].x, lastBent_.y - bent_[kNodes - 1].y};
  const F stretch = stretch_ * lateness;
  error = error + lateness * (0.5F * lengthOf(jump) + stretch * stretch * 0.2F * lengthOf(toFloatPair(v)));
  // The terms that the rule misses are smaller by powers of those that can be seen.
  const F way = toFloats(chord), inverseSpeed = step / way;
  const F second = absolute(excessQuadratic) * inverseSpeed,
          visible = absolute(excessCubic) * inverseSpeed + second * squareRoot(second);
  error = error + 4e-7F * step * sideways + 0.02F * way * visible * visible * squareRoot(visible);
  const F allowed = smaller(tolerance_, relativeTolerance_ * toFloats(length));
  const auto exact = toDoubles(error) <= toDoubles(allowed);
  const auto allowedTime = duration <= longest_;

  const auto done = plain & exact & allowedTime;
  const D exit =
      select(done, leaving_,
             select(beginsPlain, L::all(static_cast<double>(kTooLong)), L::all(static_cast<double>(kNotPlain))));
  const F ratio = squareRoot(squareRoot(allowed / error));
  const F factor = smaller(larger(0.8F * ratio, L::all(0.2F)), L::all(0.7F));
  const D shorter = smaller(select(plain, toDoubles(step * factor), 0.5 * guess), longest_);
  const D seconds = select(duration == longest_, longestSeconds_, unit_ * duration);
  L::store(exit, particles.exit + firstParticle);
  L::store(end.x, particles.end[0] + firstParticle);
  L::store(end.y, particles.end[1] + firstParticle);
  L::store(select(done, seconds, unit_ * shorter), particles.duration + firstParticle);
  L::store(base_ * length, particles.length + firstParticle);
}

/// One step of eight particles; curved: some of their faces are.
using StepEight = void (*)(ParticlesOf<8>&, const KernelLimits&);
/// As compiled for processors with AVX2; where STORMFIELD_AVX2 is defined only.
StepEight stepEightForAvx2(bool curved);

}  // namespace stormfield::lanes

#include "tracing/detail/face_step_bend.h"
