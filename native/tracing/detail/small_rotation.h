// Polynomials in single precision that rotate the vector of a corner by its twist (thesis 2.5): the same bits on every
// processor. T is a float vector of any kind. Nothing here may use the library (detail/lanes.h).
#pragma once

namespace stormfield::lanes {

/// Largest tangent for arcTangent, that of 40 degrees.
inline constexpr float kMaxTangent = 0.84F;

/// Minimax polynomial of the arc tangent for |t| <= kMaxTangent, radians.
template <typename T>
[[gnu::always_inline]] inline T arcTangent(const T& t) {
  const T q = t * t, qq = q * q;
  return t * ((0.999995058F - q * 0.333120346F) +
              qq * ((0.197340058F - q * 0.12811836F) + qq * (0.0682753295F - q * 0.0192904742F)));
}

template <typename T>
struct SmallRotation {
  T cosineLess1, sine;
};

/// Taylor polynomials of cosine - 1 and sine for angles up to 0.8 radians.
template <typename T>
[[gnu::always_inline]] inline SmallRotation<T> smallRotation(const T& angle) {
  const T s = angle * angle, ss = s * s;
  return {s * ((s * (1.0F / 24) - 1.0F / 2) + ss * (s * (1.0F / 40320) - 1.0F / 720)),
          angle * ((1.0F - s * (1.0F / 6)) + ss * (1.0F / 120 - s * (1.0F / 5040)))};
}

}  // namespace stormfield::lanes
