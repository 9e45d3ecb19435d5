// The path within one step as the cubic through its two ends with their velocities, and where it crosses an edge.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace stormfield {

/// As std::abs, without its care for numbers near the limits of double precision.
inline double magnitude(Complex a) {
  return std::sqrt(std::norm(a));
}

/// s is the fraction of the step, 0..1.
struct DenseStep {
  Complex from, to, velocityFrom, velocityTo;
  double speedFrom, speedTo, duration, length;

  Complex point(double s) const {
    const double r = 1.0 - s;
    return r * r * (1.0 + 2.0 * s) * from + s * s * (3.0 - 2.0 * s) * to +
           s * r * duration * (r * velocityFrom - s * velocityTo);
  }
  Complex velocity(double s) const {
    const double r = 1.0 - s;
    return 6.0 * s * r / duration * (to - from) + r * (1.0 - 3.0 * s) * velocityFrom + s * (3.0 * s - 2.0) * velocityTo;
  }
  /// Arc length from the start: the cubic with the length of the whole step and the speeds at its ends.
  double arcLength(double s) const {
    const double r = 1.0 - s;
    return s * s * (3.0 - 2.0 * s) * length + s * r * duration * (r * speedFrom - s * speedTo);
  }
  double fractionOfLength(double wanted, double maxFraction) const {
    double s = maxFraction * wanted / std::max(arcLength(maxFraction), 1e-300);
    for (int i = 0; i < 3; ++i) {
      const double speed = magnitude(velocity(s)) * duration;
      if (!(speed > 0.0)) break;
      s = std::clamp(s - (arcLength(s) - wanted) / speed, 0.0, maxFraction);
    }
    return s;
  }
};

/// First s in (0, 1] at which a cubic falls below zero, given its values and slopes at 0 and 1; 2 when it does not, or
/// by less than slack. It starts at a positive value, or at zero with a positive slope.
inline double firstExit(double value0, double slope0, double value1, double slope1, double slack) {
  const double a2 = 3.0 * (value1 - value0) - 2.0 * slope0 - slope1;
  const double a3 = 2.0 * (value0 - value1) + slope0 + slope1;
  const auto value = [&](double s) { return value0 + s * (slope0 + s * (a2 + s * a3)); };
  double outside = 1.0;
  if (value1 >= -slack) {
    // Inside at both ends; between them it can still dip below zero.
    if (!(slope0 < 0.0 && slope1 > 0.0)) return 2.0;
    const double root = std::sqrt(std::max(0.0, a2 * a2 - 3.0 * a3 * slope0));
    outside = -slope0 / (a2 + root);
    if (!(outside > 0.0 && outside < 1.0) || value(outside) >= -slack) return 2.0;
  }
  // Without the root at a start on the edge, the function changes its sign between 0 and outside.
  const bool onEdge = value0 == 0.0;
  const auto deflated = [&](double s) { return onEdge ? slope0 + s * (a2 + s * a3) : value(s); };
  const auto slope = [&](double s) { return onEdge ? a2 + 2.0 * s * a3 : slope0 + s * (2.0 * a2 + 3.0 * s * a3); };
  double low = 0.0, high = outside;
  const double f0 = deflated(low), f1 = deflated(high);
  double s = high * f0 / (f0 - f1);
  for (int i = 0; i < 50; ++i) {
    const double f = deflated(s);
    (f > 0.0 ? low : high) = s;
    double next = s - f / slope(s);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - s) < 1e-14) return next;
    s = next;
  }
  return s;
}

}  // namespace stormfield
