// A quadratic in lambda over one step between two samples, in the Bernstein-like form that keeps both ends exact, and
// its roots.
//
// The weights t and u = 1 - t of the two samples are kept side by side: next to an infinitesimal vector, an event at
// the end of a step is then as distinct from the end as one at the beginning is from the beginning.
//
//   const StepQuadratic q{{1.0, -3.0, 1.0}};
//   const StepQuadratic::Roots roots = q.roots();  // at t = 0.28 and 0.72
#pragma once

#include <array>
#include <cmath>
#include <utility>

namespace stormfield {

/// A time within a step: t = 0, u = 1 at its first sample, t = 1, u = 0 at its last.
struct StepTime {
  double t = 0.5, u = 0.5;

  /// t : u, of the same sign, not both 0.
  static StepTime ratio(double t, double u) { return {t / (t + u), u / (t + u)}; }
};

/// c[0] u^2 + c[1] u t + c[2] t^2: c[0] and c[2] are the values at the two samples.
struct StepQuadratic {
  std::array<double, 3> c;

  /// Derivative with respect to t.
  double slope(const StepTime& at) const { return at.u * (c[1] - 2.0 * c[0]) + at.t * (2.0 * c[2] - c[1]); }
  /// Whether all of it is above (below) the bound, by its coefficients: sufficient, not necessary.
  bool above(double bound) const { return c[0] > bound && c[1] > bound && c[2] > bound; }
  bool below(double bound) const { return c[0] < bound && c[1] < bound && c[2] < bound; }
  double size() const { return std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]); }

  struct Roots {
    int count = 0;
    std::array<StepTime, 2> times{};
  };

  /// Its roots in [0, 1] in order, a double one twice; none where it is zero everywhere. Both come from the sum that
  /// does not cancel (Higham 2002, section 1.8).
  Roots roots() const {
    const double discriminant = c[1] * c[1] - 4.0 * c[0] * c[2];
    Roots found;
    if (!(discriminant >= 0.0)) return found;
    const double half = -0.5 * (c[1] + std::copysign(std::sqrt(discriminant), c[1]));
    const auto add = [&](double t, double u) {
      if ((t > 0.0 && u < 0.0) || (t < 0.0 && u > 0.0) || t + u == 0.0) return;
      found.times[found.count++] = StepTime::ratio(t, u);
    };
    add(half, c[2]);
    add(c[0], half);
    const auto& [first, second] = found.times;
    if (found.count == 2 && first.t * second.u > second.t * first.u) std::swap(found.times[0], found.times[1]);
    return found;
  }
};

}  // namespace stormfield
