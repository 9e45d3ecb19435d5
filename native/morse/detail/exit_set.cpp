#include "morse/detail/exit_set.h"

#include <algorithm>
#include <numbers>

#include "maps/geometry_map.h"

namespace stormfield {
namespace {

/// The faces of F(N) that are not in N, ascending.
std::vector<Index> facesBeyond(const CombinatorialMap& map, const FaceSets& sets, Index set) {
  std::vector<Index> result;
  for (const Index f : sets.members(set)) {
    for (const Index* t = map.graph.begin(f); t != map.graph.end(f); ++t) {
      if (*t != map.outside() && sets.setOf(*t) != set) result.push_back(*t);
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

/// Where flow leaves over a boundary edge of the surface.
Exit boundaryExit(const VectorField& field, Index h) {
  const auto [tail, head] = endVectors(field, h);
  if (tail.imag() >= 0.0 && head.imag() >= 0.0) return Exit::None;
  if (tail.imag() > 0.0) return Exit::AtHead;
  return head.imag() > 0.0 ? Exit::AtTail : Exit::Whole;
}

IndexPair edgePair(const VectorField& field, const FaceSets& sets, Index set, const std::vector<Index>& targets) {
  const TriangleMesh& mesh = field.mesh();
  IndexPair pair;
  pair.exits.reserve(3 * sets.members(set).size());
  for (const Index f : sets.members(set)) {
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index twin = mesh.twin(h);
      if (twin == kNone) {
        pair.exits.push_back(boundaryExit(field, h));
      } else {
        const bool leaves = std::binary_search(targets.begin(), targets.end(), TriangleMesh::face(twin));
        pair.exits.push_back(leaves ? Exit::Whole : Exit::None);
      }
    }
  }
  return pair;
}

/// The component across the edge beside one of its ends: that of the end, or where it is 0, that of the other end.
double across(Complex end, Complex otherEnd) {
  return end.imag() != 0.0 ? end.imag() : otherEnd.imag();
}

/// Whether a boundary edge is crossed both ways, and at the sign change the flow runs from the exit to the entry.
bool isInternallyTangent(const VectorField& field, Index h) {
  const auto [tail, head] = endVectors(field, h);
  if (tail.imag() * head.imag() >= 0.0) return false;
  // The component along h at the sign change, times the difference across: negative from exit to entry.
  return head.real() * tail.imag() - tail.real() * head.imag() < 0.0;
}

/// Whether a trajectory inside N touches the boundary vertex of a fan of N. The fan of that angle goes
/// counter-clockwise from halfedge `first`, which leaves the vertex, to `last`, which ends there.
bool touchesReflexCorner(const VectorField& field, Index first, Index last, double angle) {
  if (angle <= std::numbers::pi) return false;
  const auto leaving = endVectors(field, first), arriving = endVectors(field, last);
  return across(leaving.tail, leaving.head) * across(arriving.head, arriving.tail) < 0.0;
}

}  // namespace

IndexPair flowPair(const VectorField& field, const CombinatorialMap& map, const FaceSets& sets, Index set) {
  return edgePair(field, sets, set, facesBeyond(map, sets, set));
}

IndexPair mapPair(const VectorField& field, const CombinatorialMap& map, const FaceSets& sets, Index set) {
  const std::vector<Index> targets = facesBeyond(map, sets, set);
  IndexPair pair = edgePair(field, sets, set, targets);
  pair.corners = Corners::Together;
  for (const Index f : targets) {
    for (int k = 0; k < 3; ++k) pair.exitVertices.push_back(field.mesh().vertex(f, k));
  }
  std::sort(pair.exitVertices.begin(), pair.exitVertices.end());
  pair.exitVertices.erase(std::unique(pair.exitVertices.begin(), pair.exitVertices.end()), pair.exitVertices.end());
  return pair;
}

int internalTangencies(const VectorField& field, const FaceSets& sets, Index set) {
  const TriangleMesh& mesh = field.mesh();
  const auto isInside = [&](Index h) { return h != kNone && sets.setOf(TriangleMesh::face(h)) == set; };
  int count = 0;
  for (const Index f : sets.members(set)) {
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (isInside(mesh.twin(h))) continue;
      if (mesh.twin(h) == kNone) count += isInternallyTangent(field, h);
      if (!mesh.isBoundaryVertex(mesh.tail(h))) continue;
      Index last = TriangleMesh::prev(h);
      double angle = mesh.cornerAngle(h);
      for (; isInside(mesh.twin(last)); last = TriangleMesh::prev(mesh.twin(last))) {
        angle += mesh.cornerAngle(mesh.twin(last));
      }
      count += touchesReflexCorner(field, h, last, angle);
    }
  }
  return count;
}

}  // namespace stormfield
