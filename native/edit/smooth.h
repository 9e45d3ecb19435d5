// Smoothing a region: its inner vectors become the smoothest ones that fit the vectors around (thesis 4.4; equation 4.1).
//
// The region may have any number of borders, and handles. Vectors outside and on its border keep their bits. Fixed
// points inside whose indices add up to zero tend to vanish; the sum of the indices inside cannot change.
//
//   const SmoothResult result = smoothRegion(field, std::vector<Index>{0, 1, 2, 3, 4, 5});
#pragma once

#include <vector>

#include "edit/edit_result.h"

namespace stormfield {

struct SmoothResult {
  VectorField field;
  std::vector<Index> vertices;  ///< that could change, ascending
  double residual = 0.0;        ///< of the equation, as a fraction of the largest vector there
  FieldChange change;
};

/// Throws InputError for a face that does not exist, a vector that is not finite, a region without an inner vertex, one
/// that covers a whole surface; SolverError where the residual stays above 1e-10.
SmoothResult smoothRegion(const VectorField& field, const std::vector<Index>& faces);

}  // namespace stormfield
