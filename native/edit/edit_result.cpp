#include "edit/edit_result.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

std::vector<Index> changedVertices(const VectorField& before, const VectorField& after) {
  std::vector<Index> vertices;
  for (std::size_t v = 0; v < before.values.size(); ++v) {
    if (before.values[v] != after.values[v]) vertices.push_back(static_cast<Index>(v));
  }
  return vertices;
}

void accept(EditResult& result, const VectorField& before, VectorField after, Topology topology,
            std::vector<EntityRef> left, std::vector<Index> faces, Fill fill) {
  result.applied = true;
  result.reason.clear();
  result.change = changeBetween(before, after);
  result.vertices = changedVertices(before, after);
  result.field = std::move(after);
  result.topology = std::move(topology);
  result.left = std::move(left);
  result.faces = std::move(faces);
  result.fill = fill;
}

}  // namespace stormfield
