// Where and when an element acts: a density that falls smoothly to zero at the rim of its region and at its ends in
// lambda, so that nothing flickers when vertices or samples enter and leave, and refinement converges (thesis 5.2.2).
#pragma once

#include <algorithm>
#include <vector>

#include "base/types.h"

namespace stormfield {

/// Core radius over radius: hard constraints act, and contradictions are refused, inside the core.
inline constexpr double kCore = 1.0 / 3.0;

/// Cover of the corners of the face that holds an element or curve: they are constrained even where the mesh does not
/// resolve the region (thesis 5.2.2).
inline constexpr double kCornerCover = 0.5;

/// Weight density of a constraint in the middle of a region, in units of 1 / size^2: stiffness / radius^2.
inline double centreDensity(double stiffness, double size, double radius) {
  const double relative = size / radius;
  return stiffness * relative * relative;
}

/// (1 - t^2)^2 inside the unit disc, t = distance / radius.
inline double falloff(double t) {
  return t < 1.0 ? (1.0 - t * t) * (1.0 - t * t) : 0.0;
}

/// 0 for x <= 0, 1 for x >= 1, smooth between.
inline double smoothStep(double x) {
  const double c = std::clamp(x, 0.0, 1.0);
  return c * c * (3.0 - 2.0 * c);
}

/// The fraction of a sample's cell [lambda - step/2, lambda + step/2] on which an element acts.
struct LambdaSpan {
  double start = 0.0, end = 1.0;
  double fade = 0.015;  ///< width of the smooth ends outside of start..end
  /// At a joined end another element takes over at exactly that lambda: there is no fade, and the sample that lies on
  /// it belongs to the side that owns it.
  bool startJoined = false, endJoined = false;
  bool ownsStart = true, ownsEnd = true;

  double share(double lambda, double step) const;
  /// Inside start..end, joined ends observed.
  bool contains(double lambda) const;
};

/// The vector that an element prescribes at one vertex of one sample.
struct Target {
  Index vertex = kNone;
  Complex value;        ///< in the chart of the vertex, mesh units per second
  double weight = 0.0;  ///< density of the soft constraint, infinite when hard
  double cover = 0.0;   ///< weight with which a singular element displaces elements of other types, 0..1
  bool core = false;
  Index element = kNone;
};

}  // namespace stormfield
