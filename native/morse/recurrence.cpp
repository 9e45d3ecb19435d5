#include "morse/recurrence.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "field/poincare_index.h"
#include "maps/geometry_map.h"

namespace stormfield {
namespace {

/// One side of the surface around a piece: faces reached from one of its boundary edges without crossing it.
class Essential {
 public:
  Essential(const TriangleMesh& mesh, const FaceSets& sets, const std::vector<char>& resting)
      : mesh_(mesh), sets_(sets), resting_(resting), seen_(mesh.faceCount(), 0), walked_(mesh.halfedgeCount(), 0) {}

  /// Whether some piece of the set has a closed curve that cannot be contracted.
  bool operator()(Index set) {
    bool found = false;
    for (const Index f : sets_.members(set)) {
      if (seen_[f] == kPiece) continue;
      const auto inSet = [&](Index g) { return sets_.setOf(g) == set; };
      const std::vector<Index> piece = flood(f, kPiece, inSet, [](Index) { return true; });
      if (isEssential(piece, set)) {
        found = true;
        break;
      }
    }
    for (const Index f : sets_.members(set)) forget(f);
    return found;
  }

 private:
  static constexpr char kPiece = 1, kOutside = 2;

  /// Faces that hang together by edges, as long as goesOn agrees with the next of them.
  template <typename Member, typename Goes>
  std::vector<Index> flood(Index start, char mark, const Member& isMember, const Goes& goesOn) {
    std::vector<Index> faces{start};
    seen_[start] = mark;
    for (std::size_t i = 0; i < faces.size() && goesOn(faces[i]); ++i) {
      for (Index h = 3 * faces[i]; h < 3 * faces[i] + 3; ++h) {
        if (mesh_.twin(h) == kNone) continue;
        const Index g = TriangleMesh::face(mesh_.twin(h));
        if (seen_[g] == mark || !isMember(g)) continue;
        seen_[g] = mark;
        faces.push_back(g);
      }
    }
    return faces;
  }

  bool isEssential(const std::vector<Index>& faces, Index set) {
    const int euler = eulerOf(faces, kPiece);
    if (euler == 1) return false;  // a disk
    int loops = 0, uncontracted = 0;
    for (const Index f : faces) {
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (walked_[h] != 0 || !isBoundary(h, kPiece)) continue;
        walkLoop(h);
        ++loops;
        if (uncontracted < 2) uncontracted += !boundsDisk(h, set);
      }
    }
    const bool planar = euler == 2 - loops;
    return !planar || uncontracted >= 2;
  }

  bool isBoundary(Index h, char mark) const {
    const Index twin = mesh_.twin(h);
    return twin == kNone || seen_[TriangleMesh::face(twin)] != mark;
  }

  void walkLoop(Index start) {
    Index h = start;
    do {
      walked_[h] = 1;
      h = TriangleMesh::next(h);
      while (!isBoundary(h, kPiece)) h = TriangleMesh::next(mesh_.twin(h));
    } while (h != start);
  }

  /// Whether beyond the boundary edge h of the set lies a disk without fixed points.
  bool boundsDisk(Index h, Index set) {
    if (mesh_.twin(h) == kNone) return false;
    bool open = true;  // as long as neither a fixed point nor the surface's boundary is met
    const auto goesOn = [&](Index f) {
      open = open && resting_[f] == 0;
      for (Index k = 3 * f; k < 3 * f + 3; ++k) open = open && mesh_.twin(k) != kNone;
      return open;
    };
    const auto beyond = flood(
        TriangleMesh::face(mesh_.twin(h)), kOutside, [&](Index g) { return sets_.setOf(g) != set; }, goesOn);
    const bool disk = open && eulerOf(beyond, kOutside) == 1;
    for (const Index f : beyond) seen_[f] = 0;
    return disk;
  }

  /// Of the faces with this mark, with corners apart: vertices are counted by fans, at the fan's last boundary edge or
  /// at the vertex's first halfedge.
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

  void forget(Index f) {
    seen_[f] = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) walked_[h] = 0;
  }

  const TriangleMesh& mesh_;
  const FaceSets& sets_;
  const std::vector<char>& resting_;
  std::vector<char> seen_, walked_;
};

}  // namespace

std::vector<char> canRecur(const TriangleMesh& mesh, const FaceSets& sets, const std::vector<char>& resting) {
  std::vector<char> result(sets.count(), 0);
  Essential essential(mesh, sets, resting);
  for (Index s = 0; s < sets.count(); ++s) {
    const std::vector<Index>& faces = sets.members(s);
    const bool rests = std::any_of(faces.begin(), faces.end(), [&](Index f) { return resting[f] != 0; });
    result[s] = rests || essential(s) ? 1 : 0;
  }
  return result;
}

}  // namespace stormfield
