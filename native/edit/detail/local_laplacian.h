// The Laplacian of a region: its free vertices are the unknowns, the others are given.
#pragma once

#include <algorithm>
#include <vector>

#include "solver/connection_laplacian.h"

namespace stormfield {

/// Calls visit(neighbour, edge, along): along is whether the edge's canonical halfedge starts at v.
template <typename Visit>
void forEachNeighbour(const TriangleMesh& mesh, Index v, Visit&& visit) {
  const auto visitEdge = [&](Index h, Index neighbour) {
    const Index canonical = mesh.edgeHalfedge(mesh.edge(h));
    visit(neighbour, mesh.edge(h), mesh.tail(canonical) == v);
  };
  for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
    visitEdge(h, mesh.head(h));
    // The last edge of a boundary fan has no outgoing halfedge of its own.
    const Index incoming = TriangleMesh::prev(h);
    if (mesh.twin(incoming) == kNone) visitEdge(incoming, mesh.tail(incoming));
  }
}

/// Weight of an edge, never zero: an edge of weight zero joins what two others join, but not always inside a region.
inline double positiveEdgeWeight(const TriangleMesh& mesh, Index e) {
  constexpr double kLeast = 1e-3;
  return std::max(edgeWeight(mesh, e), kLeast);
}

/// Number of each free vertex among the free ones, kNone for the others.
inline std::vector<Index> numbersOf(const TriangleMesh& mesh, const std::vector<Index>& freeVertices) {
  std::vector<Index> numbers(mesh.vertexCount(), kNone);
  for (std::size_t i = 0; i < freeVertices.size(); ++i) numbers[freeVertices[i]] = static_cast<Index>(i);
  return numbers;
}

}  // namespace stormfield
