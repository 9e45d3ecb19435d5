#include "morse/conley_index.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/message.h"
#include "morse/detail/union_find.h"

namespace stormfield {
namespace {

/// A set of faces as a cell complex of its own, whose vertices are classes of corners. Corner k of its i-th face has
/// the number 3 i + k, and so has the halfedge that starts there.
class FaceComplex {
 public:
  FaceComplex(const TriangleMesh& mesh, const FaceSets& sets, Index set, Corners corners)
      : mesh_(mesh),
        sets_(sets),
        set_(set),
        faces_(sets.members(set)),
        vertices_(cornerCount()),
        components_(faceCount()) {
    for (Index c = 0; c < cornerCount(); ++c) {
      const Index twin = twinOf(c);
      if (twin == kNone) {
        ++edges_;
        continue;
      }
      if (twin < c) continue;
      ++edges_;
      vertices_.join(c, TriangleMesh::next(twin));
      vertices_.join(TriangleMesh::next(c), twin);
      components_.join(c / 3, twin / 3);
    }
    if (corners == Corners::Together) joinCorners();
  }

  Index faceCount() const { return static_cast<Index>(faces_.size()); }
  Index cornerCount() const { return 3 * faceCount(); }
  Index vertex(Index corner) { return vertices_.find(corner); }
  Index meshVertex(Index corner) const { return mesh_.tail(3 * faces_[corner / 3] + corner % 3); }
  /// The twin's number where that is in the set too; kNone: the edge is on the boundary of the set.
  Index twinOf(Index corner) const {
    const Index twin = mesh_.twin(3 * faces_[corner / 3] + corner % 3);
    if (twin == kNone || sets_.setOf(TriangleMesh::face(twin)) != set_) return kNone;
    return 3 * sets_.placeOf(TriangleMesh::face(twin)) + TriangleMesh::corner(twin);
  }
  /// Of the faces that hang together by edges.
  Index component(Index face) { return components_.find(face); }

  int euler() {
    Index count = 0;
    for (Index c = 0; c < cornerCount(); ++c) count += vertex(c) == c;
    return count - edges_ + faceCount();
  }

 private:
  void joinCorners() {
    std::vector<std::pair<Index, Index>> byVertex;
    byVertex.reserve(cornerCount());
    for (Index c = 0; c < cornerCount(); ++c) byVertex.emplace_back(meshVertex(c), c);
    std::sort(byVertex.begin(), byVertex.end());
    for (std::size_t i = 1; i < byVertex.size(); ++i) {
      if (byVertex[i].first == byVertex[i - 1].first) vertices_.join(byVertex[i].second, byVertex[i - 1].second);
    }
  }

  const TriangleMesh& mesh_;
  const FaceSets& sets_;
  Index set_;
  const std::vector<Index>& faces_;
  UnionFind vertices_, components_;
  Index edges_ = 0;
};

struct ExitSet {
  std::vector<char> vertices;  ///< per corner, 1 at the corner that names a vertex of L
  int euler = 0;
};

ExitSet exitSet(FaceComplex& n, const IndexPair& pair) {
  ExitSet l{std::vector<char>(n.cornerCount(), 0)};
  for (Index c = 0; c < n.cornerCount(); ++c) {
    const Index vertex = n.meshVertex(c);
    if (std::binary_search(pair.exitVertices.begin(), pair.exitVertices.end(), vertex)) l.vertices[n.vertex(c)] = 1;
    const Exit exit = pair.exits[c];
    if (exit == Exit::None || n.twinOf(c) != kNone) continue;
    // A piece of an edge contracts to its end; only whole edges are cells of L.
    if (exit != Exit::AtHead) l.vertices[n.vertex(c)] = 1;
    if (exit != Exit::AtTail) l.vertices[n.vertex(TriangleMesh::next(c))] = 1;
    if (exit == Exit::Whole) --l.euler;
  }
  l.euler += static_cast<int>(std::count(l.vertices.begin(), l.vertices.end(), 1));
  return l;
}

/// Components of N, where vertices connect too, that L does not meet.
int componentsWithoutExit(FaceComplex& n, const ExitSet& l) {
  UnionFind joined(n.cornerCount());
  for (Index c = 0; c < n.cornerCount(); ++c) {
    joined.join(c, n.vertex(c));
    joined.join(c, c - c % 3);
  }
  std::vector<char> meetsExit(n.cornerCount(), 0);
  for (Index c = 0; c < n.cornerCount(); ++c) {
    if (l.vertices[c] != 0) meetsExit[joined.find(c)] = 1;
  }
  int count = 0;
  for (Index c = 0; c < n.cornerCount(); ++c) count += joined.find(c) == c && meetsExit[c] == 0;
  return count;
}

/// Components of N, where only edges connect, whose boundary is in L: these are the cycles of H2(N, L).
int componentsBoundedByExit(FaceComplex& n, const IndexPair& pair) {
  std::vector<char> open(n.faceCount(), 0);
  for (Index c = 0; c < n.cornerCount(); ++c) {
    if (n.twinOf(c) == kNone && pair.exits[c] != Exit::Whole) open[n.component(c / 3)] = 1;
  }
  int count = 0;
  for (Index f = 0; f < n.faceCount(); ++f) count += n.component(f) == f && open[f] == 0;
  return count;
}

void checkPair(const TriangleMesh& mesh, const FaceSets& sets, Index set, const IndexPair& pair) {
  if (static_cast<Index>(sets.setOf().size()) != mesh.faceCount()) {
    throw InputError(message("the sets are of ", sets.setOf().size(), " faces, but the mesh has ", mesh.faceCount(),
                             "; make them on the same mesh"));
  }
  if (set < 0 || set >= sets.count()) {
    throw InputError(message("there is no set ", set, " of faces; there are ", sets.count()));
  }
  if (pair.exits.size() != 3 * sets.members(set).size()) {
    throw InputError(message("the index pair has ", pair.exits.size(), " exits, but set ", set, " has ",
                             sets.members(set).size(), " faces; give three for each"));
  }
  if (!pair.exitVertices.empty() && pair.corners == Corners::Apart) {
    throw InputError("the index pair has exit vertices, which are several points with corners apart; set corners");
  }
  if (!std::is_sorted(pair.exitVertices.begin(), pair.exitVertices.end())) {
    throw InputError("the exit vertices of the index pair do not ascend; sort them");
  }
}

/// A least triple from this one on with b0 - b1 + b2 = euler.
ConleyIndex raised(ConleyIndex index, int euler) {
  index.b1 += std::max(0, index.euler() - euler);
  while (index.euler() < euler) ++(index.b2 <= index.b0 ? index.b2 : index.b0);
  return index;
}

}  // namespace

MorseKind kindOf(const ConleyIndex& index) {
  if (index == ConleyIndex{0, 0, 1}) return MorseKind::Source;
  if (index == ConleyIndex{1, 0, 0}) return MorseKind::Sink;
  if (index == ConleyIndex{0, 1, 0}) return MorseKind::Saddle;
  if (index == ConleyIndex{1, 1, 0}) return MorseKind::Attracting;
  if (index == ConleyIndex{0, 1, 1}) return MorseKind::Repelling;
  return index == ConleyIndex{} ? MorseKind::Trivial : MorseKind::Other;
}

ConleyIndex conleyIndex(const TriangleMesh& mesh, const FaceSets& sets, Index set, const IndexPair& pair) {
  checkPair(mesh, sets, set, pair);
  FaceComplex n(mesh, sets, set, pair.corners);
  const ExitSet l = exitSet(n, pair);
  const int b0 = componentsWithoutExit(n, l), b2 = componentsBoundedByExit(n, pair);
  return {b0, b0 + b2 - (n.euler() - l.euler), b2};
}

ConleyIndex matchPoincareSum(const ConleyIndex& bound, int poincareSum) {
  // Each number is largest where the numbers of the other sign are as large as the bound allows.
  const ConleyIndex result{std::min(bound.b0, bound.b1 + poincareSum),
                           std::min(bound.b1, bound.b0 + bound.b2 - poincareSum),
                           std::min(bound.b2, bound.b1 + poincareSum)};
  return std::min({result.b0, result.b1, result.b2}) < 0 ? raised(bound, poincareSum) : result;
}

}  // namespace stormfield
