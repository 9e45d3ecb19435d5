#include "morse/recurrence.h"

#include <algorithm>

namespace stormfield {
namespace {

/// Finds essential curves: closed curves in a set that cannot be contracted without crossing a fixed point. A component
/// of a set is its faces that hang together by edges, a side of it the faces that are reached from one of its boundary
/// loops without entering the set.
class EssentialCurves {
 public:
  EssentialCurves(const TriangleMesh& mesh, const FaceSets& sets, const std::vector<char>& fixedPointFaces)
      : mesh_(mesh),
        sets_(sets),
        fixedPointFaces_(fixedPointFaces),
        mark_(mesh.faceCount(), 0),
        visited_(mesh.halfedgeCount(), 0) {}

  /// Whether a component of the set has one.
  bool isIn(Index set) {
    bool found = false;
    for (const Index f : sets_.members(set)) {
      if (mark_[f] == kComponent) continue;
      const auto inSet = [&](Index g) { return sets_.setOf(g) == set; };
      if (isInComponent(flood(f, kComponent, inSet, [](Index) { return true; }), set)) {
        found = true;
        break;
      }
    }
    for (const Index f : sets_.members(set)) clearMarks(f);
    return found;
  }

 private:
  static constexpr char kComponent = 1, kSide = 2;

  /// Marks and returns the members that hang together with `start` by edges, until goesOn(face) is false.
  template <typename IsMember, typename GoesOn>
  std::vector<Index> flood(Index start, char mark, const IsMember& isMember, const GoesOn& goesOn) {
    std::vector<Index> faces{start};
    mark_[start] = mark;
    for (std::size_t i = 0; i < faces.size() && goesOn(faces[i]); ++i) {
      for (Index h = 3 * faces[i]; h < 3 * faces[i] + 3; ++h) {
        if (mesh_.twin(h) == kNone) continue;
        const Index g = TriangleMesh::face(mesh_.twin(h));
        if (mark_[g] == mark || !isMember(g)) continue;
        mark_[g] = mark;
        faces.push_back(g);
      }
    }
    return faces;
  }

  /// The holes of a planar component are filled where the side beyond is a disk without fixed points. With at most one
  /// hole left it is a disk, in which every curve contracts. Where it is not planar, some curve does not.
  bool isInComponent(const std::vector<Index>& faces, Index set) {
    const int euler = eulerOf(faces, kComponent);
    if (euler == 1) return false;  // a disk
    int loops = 0, uncontracted = 0;
    for (const Index f : faces) {
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (visited_[h] != 0 || !isBoundary(h, kComponent)) continue;
        visitLoop(h);
        ++loops;
        if (uncontracted < 2) uncontracted += !boundsDisk(h, set);
      }
    }
    const bool planar = euler == 2 - loops;
    return !planar || uncontracted >= 2;
  }

  bool isBoundary(Index h, char mark) const {
    const Index twin = mesh_.twin(h);
    return twin == kNone || mark_[TriangleMesh::face(twin)] != mark;
  }

  void visitLoop(Index start) {
    Index h = start;
    do {
      visited_[h] = 1;
      h = TriangleMesh::next(h);
      while (!isBoundary(h, kComponent)) h = TriangleMesh::next(mesh_.twin(h));
    } while (h != start);
  }

  /// Whether the side of the set beyond its boundary edge h is a disk without fixed points.
  bool boundsDisk(Index h, Index set) {
    if (mesh_.twin(h) == kNone) return false;
    bool allowed = true;  // neither a fixed point nor the surface's boundary so far
    const auto goesOn = [&](Index f) {
      allowed = allowed && fixedPointFaces_[f] == 0;
      for (Index k = 3 * f; k < 3 * f + 3; ++k) allowed = allowed && mesh_.twin(k) != kNone;
      return allowed;
    };
    const std::vector<Index> side = flood(
        TriangleMesh::face(mesh_.twin(h)), kSide, [&](Index g) { return sets_.setOf(g) != set; }, goesOn);
    const bool isDisk = allowed && eulerOf(side, kSide) == 1;
    for (const Index f : side) mark_[f] = 0;
    return isDisk;
  }

  /// Euler characteristic of the faces with this mark, with corners apart: each fan of them at a vertex counts as one
  /// vertex, at its last boundary edge, or at the vertex's first halfedge where the fan closes.
  int eulerOf(const std::vector<Index>& faces, char mark) const {
    int vertices = 0, doubledEdges = 0;
    for (const Index f : faces) {
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        const bool boundary = isBoundary(h, mark);
        doubledEdges += boundary ? 2 : 1;
        vertices += boundary || (mesh_.outgoing(mesh_.tail(h)) == h && isWholeFan(h, mark));
      }
    }
    return vertices - doubledEdges / 2 + static_cast<int>(faces.size());
  }

  bool isWholeFan(Index h, char mark) const {
    for (Index g = h; g != kNone; g = mesh_.nextOutgoing(g)) {
      if (isBoundary(g, mark)) return false;
    }
    return true;
  }

  void clearMarks(Index f) {
    mark_[f] = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) visited_[h] = 0;
  }

  const TriangleMesh& mesh_;
  const FaceSets& sets_;
  const std::vector<char>& fixedPointFaces_;
  std::vector<char> mark_, visited_;
};

}  // namespace

std::vector<char> canRecur(const TriangleMesh& mesh, const FaceSets& sets, const std::vector<char>& fixedPointFaces) {
  std::vector<char> result(sets.count(), 0);
  EssentialCurves curves(mesh, sets, fixedPointFaces);
  for (Index s = 0; s < sets.count(); ++s) {
    const std::vector<Index>& faces = sets.members(s);
    const bool holdsFixedPoint =
        std::any_of(faces.begin(), faces.end(), [&](Index f) { return fixedPointFaces[f] != 0; });
    result[s] = holdsFixedPoint || curves.isIn(s) ? 1 : 0;
  }
  return result;
}

}  // namespace stormfield
