#include "edit/edit_result.h"

#include <algorithm>
#include <cmath>

namespace stormfield {

FieldChange changeBetween(const VectorField& before, const VectorField& after) {
  FieldChange change;
  for (std::size_t v = 0; v < before.values.size(); ++v) {
    const Complex a = before.values[v], b = after.values[v];
    if (a == b) continue;
    change.largest = std::max(change.largest, std::abs(b - a));
    if (a == 0.0 || b == 0.0) continue;
    change.largestAngle = std::max(change.largestAngle, std::abs(std::arg(b / a)));
    change.largestLength = std::max(change.largestLength, std::abs(std::abs(b) / std::abs(a) - 1.0));
  }
  return change;
}

}  // namespace stormfield
