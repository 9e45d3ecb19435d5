// What curved faces need beyond detail/face_step_affine.h: the correction to the affine part of the field, and what it
// adds to the path.
#pragma once

#include "tracing/detail/face_step_kernel.h"
#include "tracing/detail/small_rotation.h"

namespace stormfield::lanes {

/// The field less its affine part.
template <int Bytes, int Count, bool Curved>
template <typename Point>
auto FaceStepKernel<Bytes, Count, Curved>::correction(const Point& p) const -> Point {
  using G = std::remove_const_t<decltype(p.x)>;
  const auto all = [](float a) { return Lanes<sizeof(G)>::all(a); };
  const G b[3] = {1.0F - p.x - p.y, p.x, p.y};
  Point sum = {G(), G()};
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3, previous = (i + 2) % 3;
    // Of the line from the corner, in the frame of its bisector.
    const G alongNext = b[next] * sides_[i], alongPrevious = b[previous] * sides_[previous];
    const G x = alongNext + alongPrevious, y = tanHalf_[i] * (alongPrevious - alongNext);
    const G t = y / larger(x + squareRoot(x * x + y * y), all(1e-30F));
    const G bounded = smaller(larger(t, all(-kMaxTangent)), all(kMaxTangent));
    const auto [cosineLess1, sine] = smallRotation(G(doubleTwist_[i] * arcTangent(bounded)));
    sum.x = sum.x + b[i] * (floatRate_[i].x * cosineLess1 + rotated_[i].x * sine);
    sum.y = sum.y + b[i] * (floatRate_[i].y * cosineLess1 + rotated_[i].y * sine);
  }
  return sum;
}

/// A single particle has them side by side.
template <int Bytes, int Count, bool Curved>
template <int Points>
void FaceStepKernel<Bytes, Count, Curved>::correctionsAt(const FloatPair* p, FloatPair* c) const {
#if defined(__SSE2__)
  if constexpr (Bytes == 4) {
    constexpr int kLast = Points - 1;
    struct {
      Floats16 x, y;
    } nodes = {{p[0].x, p[1].x, p[kLast - 1].x, p[kLast].x}, {p[0].y, p[1].y, p[kLast - 1].y, p[kLast].y}};
    nodes = correction(nodes);
    for (int i = 0; i < Points; ++i) c[i] = {nodes.x[i], nodes.y[i]};
    return;
  }
#endif
  for (int i = 0; i < Points; ++i) c[i] = correction(p[i]);
}

/// Half way to where the affine part, with its rate at the start, leaves the face.
template <int Bytes, int Count, bool Curved>
auto FaceStepKernel<Bytes, Count, Curved>::correctionNearMiddle(const FloatPair& v) const -> FloatPair {
  const FloatPair b = toFloatPair(start_), a = jacobian(v);
  const F coordinates[3] = {third(b), b.x, b.y}, rates[3] = {rateOfThird(v), v.x, v.y};
  F first = 1.0F / larger(stretch_, L::all(1e-30F));
  for (int i = 0; i < 3; ++i) {
    // Not the side of entry, where the coordinate is zero but for round-off.
    const F t = -coordinates[i] / rates[i];
    first = select((rates[i] < 0.0F) & (coordinates[i] > 1e-7F), smaller(first, t), first);
  }
  const F half = 0.5F * smaller(first, toFloats(maxTime_));
  const F zero = L::all(0.0F), one = L::all(1.0F);
  const FloatPair middle = {smaller(larger(b.x + half * (v.x + 0.5F * half * a.x), zero), one),
                            smaller(larger(b.y + half * (v.y + 0.5F * half * a.y), zero), one)};
  return correction(middle);
}

/// What the correction, less the constant, adds to the path; the estimated error of that, in bases.
template <int Bytes, int Count, bool Curved>
auto FaceStepKernel<Bytes, Count, Curved>::bend() -> F {
  const F duration = toFloats(duration_);
  const auto displacement = [&](const FloatPair* rate, int i) {
    FloatPair sum = {F(), F()};
    for (int j = 0; j < kNodes; ++j) {
      sum = {sum.x + kIntegral[i][j] * rate[j].x, sum.y + kIntegral[i][j] * rate[j].y};
    }
    return FloatPair{duration * sum.x, duration * sum.y};
  };
  // The correction is evaluated at the displaced points. The bend displaces the middle of the path most: by how much
  // follows from the outer points, because the correction less the constant vanishes near the middle.
  FloatPair seen[kNodes], moved[kNodes];
  const FloatPair outer[2] = {node_[0], node_[3]};
  correctionsAt<2>(outer, seen);
  const FloatPair first = {seen[0].x - constant_.x, seen[0].y - constant_.y};
  const FloatPair last = {seen[1].x - constant_.x, seen[1].y - constant_.y};
  FloatPair guess[2], inner[2];
  for (int i = 0; i < 2; ++i) {
    guess[i] = {duration * (kGuess[i] * first.x + kGuess[i + 2] * last.x),
                duration * (kGuess[i] * first.y + kGuess[i + 2] * last.y)};
    inner[i] = {node_[i + 1].x + guess[i].x, node_[i + 1].y + guess[i].y};
  }
  correctionsAt<2>(inner, seen + 1);
  bent_[0] = first;
  bent_[3] = last;
  for (int i = 1; i < 3; ++i) bent_[i] = {seen[i].x - constant_.x, seen[i].y - constant_.y};
  // How many times nearer to a corner the path begins or ends than it is long.
  const FloatPair from = floatSeries_[0], to = toFloatPair(end_);
  const auto distance = [](const FloatPair& p) { return 1.0F - larger(larger(p.x, p.y), third(p)); };
  const F dx = absolute(to.x - from.x), dy = absolute(to.y - from.y);
  const F nearest = larger(smaller(distance(from), distance(to)), L::all(1e-6F));
  const F nearness = larger(larger(dx, dy), absolute((to.x + to.y) - (from.x + from.y))) / nearest;

  F displacedBy = L::all(0.0F);
  for (int i = 0; i < kNodes; ++i) {
    moved[i] = displacement(bent_, i);
    const FloatPair seenAt = i == 1 || i == 2 ? guess[i - 1] : FloatPair{F(), F()};
    displacedBy = displacedBy + kWeight[i] * (absolute(moved[i].x - seenAt.x) + absolute(moved[i].y - seenAt.y));
  }
  // By the gradient of the correction c, some 2 c per length, and more next to a corner.
  const F size = lengthOf(constant_), gradient = 2.0F * size * (1.0F + kGradientNear * nearness);
  F missing = kSecondLook * duration * gradient * displacedBy;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const auto again = missing > 0.5F * tolerance_;
    if (!isAny(again)) break;
    FloatPair next[kNodes], rate[kNodes], displaced[kNodes];
    for (int i = 0; i < kNodes; ++i) {
      const FloatPair added = jacobian(moved[i]);
      rate[i] = {bent_[i].x + added.x, bent_[i].y + added.y};
    }
    F change = L::all(0.0F);
    for (int i = 0; i < kNodes; ++i) {
      const FloatPair d = displacement(rate, i);
      moved[i] = {select(again, d.x, moved[i].x), select(again, d.y, moved[i].y)};
      displaced[i] = {node_[i].x + moved[i].x, node_[i].y + moved[i].y};
    }
    correctionsAt<kNodes>(displaced, seen);
    for (int i = 0; i < kNodes; ++i) {
      next[i] = {seen[i].x - constant_.x, seen[i].y - constant_.y};
      change = larger(change, absolute(next[i].x - bent_[i].x) + absolute(next[i].y - bent_[i].y));
    }
    for (int i = 0; i < kNodes; ++i) {
      bent_[i] = {select(again, next[i].x, bent_[i].x), select(again, next[i].y, bent_[i].y)};
    }
    missing = select(again, duration * change * smaller(3.0F * duration * gradient, L::all(0.25F)), missing);
  }

  for (int i = 0; i < kNodes; ++i) node_[i] = {node_[i].x + moved[i].x, node_[i].y + moved[i].y};

  // The exponential of the Jacobian, by its first terms.
  FloatPair weighted[kNodes], moment[kMoments];
  for (int i = 0; i < kNodes; ++i) weighted[i] = {kWeight[i] * bent_[i].x, kWeight[i] * bent_[i].y};
  for (int k = 0;; ++k) {
    moment[k] = {(weighted[0].x + weighted[1].x) + (weighted[2].x + weighted[3].x),
                 (weighted[0].y + weighted[1].y) + (weighted[2].y + weighted[3].y)};
    if (k + 1 == kMoments) break;
    for (int i = 0; i < kNodes; ++i) {
      const F left = duration * ((1.0F - kPoint[i]) / static_cast<float>(k + 1));
      weighted[i] = {left * weighted[i].x, left * weighted[i].y};
    }
  }
  FloatPair sum = moment[kMoments - 1];
  for (int k = kMoments - 1; k-- > 0;) {
    const FloatPair added = jacobian(sum);
    sum = {moment[k].x + added.x, moment[k].y + added.y};
  }
  displacement_ = {duration * sum.x, duration * sum.y};
  firstBent_ = lastBent_ = {F(), F()};
  FloatPair cubic = {F(), F()};
  F residual = L::all(0.0F);
  for (int i = 0; i < kNodes; ++i) {
    firstBent_ = {firstBent_.x + kAtStart[i] * bent_[i].x, firstBent_.y + kAtStart[i] * bent_[i].y};
    lastBent_ = {lastBent_.x + kAtStart[kNodes - 1 - i] * bent_[i].x,
                 lastBent_.y + kAtStart[kNodes - 1 - i] * bent_[i].y};
    cubic = {cubic.x + kCubic[i] * bent_[i].x, cubic.y + kCubic[i] * bent_[i].y};
    residual = larger(residual, absolute(bent_[i].x) + absolute(bent_[i].y));
  }
  // Next to a corner the rule misses much of the rotation around it.
  const F rule = smaller(smaller(kRule * nearness, kRuleNear * nearness * nearness), L::all(kMaxRule));
  const F stretch = duration * stretch_, squared = stretch * stretch;
  // And round-off.
  const F rounding = kBendRounding * (size + residual);
  return missing +
         duration * (rounding + rule * lengthOf(cubic) + residual * squared * squared * squared * stretch / 40320.0F);
}

}  // namespace stormfield::lanes
