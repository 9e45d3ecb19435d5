#include "edit/detail/rotation_fill.h"

#include <algorithm>

#include "edit/detail/local_laplacian.h"

namespace stormfield {
namespace {

constexpr double kAngles[] = {0.15, 0.35, 0.7, 1.1, 1.5};

/// Per free vertex the number of edges to the nearest one that is not free.
std::vector<int> depths(const TriangleMesh& mesh, const std::vector<Index>& freeVertices) {
  const std::vector<Index> numbers = numbersOf(mesh, freeVertices);
  std::vector<int> depth(freeVertices.size(), 0);
  std::vector<Index> order;
  for (std::size_t i = 0; i < freeVertices.size(); ++i) {
    bool besideGiven = false;
    forEachNeighbour(mesh, freeVertices[i],
                     [&](Index neighbour, Index, bool) { besideGiven = besideGiven || numbers[neighbour] == kNone; });
    if (!besideGiven) continue;
    depth[i] = 1;
    order.push_back(static_cast<Index>(i));
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    forEachNeighbour(mesh, freeVertices[order[i]], [&](Index neighbour, Index, bool) {
      const Index next = numbers[neighbour];
      if (next == kNone || depth[next] != 0) return;
      depth[next] = depth[order[i]] + 1;
      order.push_back(next);
    });
  }
  return depth;
}

}  // namespace

std::vector<VectorField> rotationFills(const VectorField& field, const std::vector<Index>& freeVertices) {
  const std::vector<int> depth = depths(field.mesh(), freeVertices);
  // The whole angle in the inner half.
  const int whole = std::max(1, *std::max_element(depth.begin(), depth.end()) / 2);
  std::vector<VectorField> fills;
  for (const double angle : kAngles) {
    for (const double sign : {1.0, -1.0}) {
      VectorField turned = field;
      for (std::size_t i = 0; i < freeVertices.size(); ++i) {
        const double part = std::min(1.0, static_cast<double>(depth[i]) / whole);
        turned.values[freeVertices[i]] *= std::polar(1.0, sign * part * angle);
      }
      fills.push_back(std::move(turned));
    }
  }
  return fills;
}

}  // namespace stormfield
