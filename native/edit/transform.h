// Turning, scaling and stretching a field over lambda (thesis 11.1.3.4, there Jacobian- or matrix-based design).
//
// The field at lambda is M(lambda) V(lambda), or M(lambda) V(lambda_s) where it is frozen at the first key. M stretches
// along an axis, then scales, then turns counter-clockwise. Keys give angle and factors at some lambda; in between the
// angle is linear and the factors are geometric, so that equal steps of lambda multiply by equal matrices. M is the same
// for any number of samples: it is no product of rounded steps. Before the first key nothing changes, after the last one
// M stays.
//
// A vertex of weight w gets the w-th part of the angle and the w-th power of the factors; one of weight 0 keeps its bits.
//
//   const ParameterizedField turned = transformField(field, {.keys = {{0.0}, {1.0, 0.5 * std::numbers::pi}}});
#pragma once

#include <vector>

#include "base/words.h"
#include "field/parameterized_field.h"

namespace stormfield {

/// M at one lambda.
struct TransformKey {
  double lambda = 0.0;
  double angle = 0.0;    ///< radians, counter-clockwise seen from outside
  double scale = 1.0;    ///< factor of all lengths, above 0
  double stretch = 1.0;  ///< factor of lengths along the axis, above 0
};

enum class TransformOf { FieldAsItIs, FieldAtFirstKey };
template <>
inline constexpr Words kWords<TransformOf>{"source", {"as_it_is", "frozen"}};

struct TransformOptions {
  std::vector<TransformKey> keys = {};  ///< at least one, lambda increasing
  TransformOf source = TransformOf::FieldAsItIs;
  std::vector<double> weights = {};  ///< per vertex 0..1; empty: 1 everywhere
  /// Per sample and vertex what is stretched along, as the field's values, no longer than 1: a vector p stretches by k
  /// as V + (k - 1) (p . V) p. Empty where no key stretches.
  FieldValues axes = {};
};

/// Throws InputError for keys that are missing, not finite, not increasing or have factors that are not above 0, for
/// weights and axes of a wrong size or length, and for a stretch without axes.
ParameterizedField transformField(const ParameterizedField& field, const TransformOptions& options);

/// 1 at vertices of these faces, falling smoothly (as cos^2 of the length along edges) to 0 at this distance from them,
/// mesh units; a distance of 0: at once. Throws InputError for a face that does not exist and a negative distance.
std::vector<double> falloffWeights(const TriangleMesh& mesh, const std::vector<Index>& faces, double falloff);

}  // namespace stormfield
