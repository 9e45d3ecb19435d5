// The whole step of detail/face_step_kernel.h: the affine path, its bend, the exact end on the side, length and error.
#pragma once

#include "tracing/detail/face_step_affine.h"
#include "tracing/detail/face_step_bend.h"

namespace stormfield::lanes {

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
  const Pair added = jacobian(Pair{end.x - start_.x, end.y - start_.y});
  const Pair v = {series_[1].x + added.x + toDoubles(lastBent_.x), series_[1].y + added.y + toDoubles(lastBent_.y)};
  const D ends[3] = {third(end), end.x, end.y}, rates[3] = {-v.x - v.y, v.x, v.y};
  // The neglected correction must not decide which side the path enters or leaves by: adjacent faces have to agree.
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

  // Inside the face throughout: at the points of Gauss' rule, and between them by the directions at the ends.
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
  F excess = L::all(0.0F), excessQuadratic = excess, excessCubic = excess, slowest = L::all(kNever),
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

  // The error: of the series, the bend, the last piece of path to the side, the length.
  const F squaredTime = step * step, fourth = squaredTime * squaredTime;
  error = error + smaller((1.0F / 13) * stretch_ * step, L::all(0.5F)) * size_ * (fourth * fourth * fourth) *
                      toFloats(absolute(series_[kOrder].x) + absolute(series_[kOrder].y));
  const FloatPair jump = {lastBent_.x - bent_[kNodes - 1].x, lastBent_.y - bent_[kNodes - 1].y};
  const F stretch = stretch_ * lateness;
  error = error + lateness * (0.5F * lengthOf(jump) + stretch * stretch * kLateCubic * lengthOf(toFloatPair(v)));
  // The terms that the rule misses are estimated by powers of the visible ones.
  const F path = toFloats(chord), inverseSpeed = step / path;
  const F second = absolute(excessQuadratic) * inverseSpeed,
          visible = absolute(excessCubic) * inverseSpeed + second * squareRoot(second);
  error = error + kLengthRounding * step * sideways + kLengthRule * path * visible * visible * squareRoot(visible);
  const F allowed = smaller(tolerance_, relativeTolerance_ * toFloats(length));
  const auto exact = toDoubles(error) <= toDoubles(allowed);
  const auto allowedTime = duration <= maxTime_;

  const auto done = plain & exact & allowedTime;
  const D exit =
      select(done, leaving_,
             select(beginsPlain, L::all(static_cast<double>(kTooLong)), L::all(static_cast<double>(kNotPlain))));
  const F ratio = squareRoot(squareRoot(allowed / error));
  const F factor = smaller(larger(kCaution * ratio, L::all(kMinFactor)), L::all(kMaxFactor));
  const D shorter = smaller(select(plain, toDoubles(step * factor), 0.5 * guess), maxTime_);
  const D seconds = select(duration == maxTime_, maxSeconds_, unit_ * duration);
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
