// The transit map: the geometry-based combinatorial map (thesis 2.4.2, 6.2) with pieces of edges for its nodes, which
// remembers where flow enters a face.
//
// Every edge is cut into pieces that flow crosses in one direction. A piece leads to the pieces over which what enters
// through it leaves the next face; what stays in a face, or comes from within, leads to or from its node of rest. The
// transit map of a face is monotone (face_transit.h), so that the image of a piece lies on the arc of the face's
// boundary between those of its two ends. It is enclosed to a slack of round-off size, not padded by what may happen
// between samples, and halving a piece halves its image: what tau maps reach with longer times is reached by crossing
// one face at a time. Rows depend on their own pieces alone, so that any order of halving leads to the same map.
//
// Faces with a fixed point on an edge or at a vertex are known by the directions across their edges only: whatever
// enters leads to rest and to all exits. An edge that the flow runs along is one piece, a trajectory that is crossed by
// none: what enters a face beside its first end leads to it, and it leads to what leaves its two faces beside its other
// end.
//
// With an error bound epsilon > 0 the map holds for every field within it (cone_transit.h), and what is said above
// about the field is said about all of these: pieces that some cross one way and some the other enter both faces, a
// piece leads to whatever lies over its arcs of leaving, and faces that some field rests in are known by their exits
// only. Rows grow with epsilon as long as the pieces stay what they are.
//
//   TransitMap map(faces, field);
//   map.halve(pieces);
//   const CombinatorialMap whole = map.map();       // faces' nodes of rest, pieces, outside
//   const TransitMap bounded = map.withinEpsilon(cones);   // the same pieces, for all fields within cones->epsilon()
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "maps/combinatorial_map.h"
#include "maps/detail/cone_transit.h"
#include "maps/detail/face_transit.h"

namespace stormfield {

/// Part of an edge, from one fraction of its canonical halfedge to another.
struct EdgePiece {
  static constexpr Index kOutside = -1, kBothFaces = -2, kAlong = -3;

  Index edge = kNone;
  Index enters = kOutside;  ///< face; kAlong: none, it runs along the edge
  int level = 0;            ///< halvings
  double from = 0.0, to = 1.0;
  /// Where its ends leave the face that they enter (limits from within): FaceTransit's positions.
  double imageFrom = FaceTransit::kRest, imageTo = FaceTransit::kRest;
};

class TransitMap {
 public:
  /// faces: of the field's mesh. cones: of the same field; null for the map of the field itself. Throws Cancelled.
  TransitMap(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
             Progress* progress = nullptr, std::shared_ptr<const ConeTransit> cones = nullptr);

  /// The map of the same pieces for all fields within an error bound.
  TransitMap withinEpsilon(std::shared_ptr<const ConeTransit> cones) const;

  const FaceTransit& faceTransit() const { return *transit_; }
  const TriangleMesh& mesh() const { return transit_->mesh(); }
  /// Nodes: one of rest for each face, then the pieces, then outside.
  Index pieceCount() const { return static_cast<Index>(pieces_.size()); }
  Index nodeOf(Index piece) const { return mesh().faceCount() + piece; }
  bool isPiece(Index node) const { return node >= mesh().faceCount() && node < outside(); }
  const EdgePiece& piece(Index node) const { return pieces_[node - mesh().faceCount()]; }
  Index outside() const { return mesh().faceCount() + pieceCount(); }

  /// Halves the pieces of some nodes. The first half keeps the piece's node, the second gets a new one at the end;
  /// returns for each of these the place in `nodes` of the first. All or nothing; throws Cancelled.
  std::vector<std::size_t> halve(const std::vector<Index>& nodes, Progress* progress = nullptr);

  /// The nodes that a node leads to, ascending.
  void row(Index node, std::vector<Index>& targets) const;
  CombinatorialMap map(Progress* progress = nullptr) const;
  /// Visits all nodes but outside: those of rest, then the pieces edge by edge, along each. What lies together comes
  /// together, while the numbers of halves are far apart: work in this order finds in the cache what it needs.
  template <typename Visit>
  void eachNode(const Visit& visit) const {
    for (Index f = 0; f < mesh().faceCount(); ++f) visit(f);
    for (const Place& place : places_) visit(nodeOf(place.piece));
  }
  /// The edges among some nodes, by their places in the list.
  DirectedGraph graphAmong(const std::vector<Index>& nodes, Progress* progress) const;
  /// Appends the faces that a node lies in, or that flow enters through it.
  void appendFaces(Index node, std::vector<Index>& faces) const;
  /// Per face whether some field within the bound can rest in it.
  const std::vector<char>& fixedPointFaces() const {
    return cones_ ? cones_->fixedPointFaces() : transit_->fixedPointFaces();
  }
  /// Whether halving changes nothing: what enters faces that are known by their exits only, or leaves the surface.
  bool isSettled(Index node) const;
  std::size_t bytes() const { return sizeof(EdgePiece) * pieces_.capacity(); }

 private:
  /// A face with a fixed point: the continuous parts of its arcs of entry, where what comes to rest enters, and where
  /// what comes from there leaves (single positions at a saddle).
  struct Rest {
    std::vector<ContinuousArc> parts;
    std::vector<BoundaryArc> in, out;
  };
  struct Cut {
    double to, imageFrom, imageTo;
  };
  using Cuts = std::vector<Cut>;
  /// What a search along an edge asks of a piece, beside those of its neighbours: the pieces themselves are far apart.
  struct Place {
    double to;
    Index piece, enters;
  };

  Place placeOf(Index piece) const { return {pieces_[piece].to, piece, pieces_[piece].enters}; }
  DirectedGraph graphByPlace(const std::vector<Index>& nodes, const std::vector<Index>& place,
                             Progress* progress) const;
  double positionIn(Index f, Index edge, double fraction) const;
  void cut(const EdgePiece& piece, Cuts& cuts) const;
  void cutAtJumps(const EdgePiece& piece, const Rest& rest, Cuts& cuts) const;
  void findRests(Progress* progress);
  template <typename Visit>
  void eachExit(Index f, const BoundaryArc& arc, const Visit& visit) const;
  void addExits(Index f, const EdgePiece& piece, std::vector<Index>& targets) const;
  double touched(Index f, double position) const;
  std::pair<double, double> jumpBetween(Index f, double first, double last) const;
  void enter(Index f, const EdgePiece& piece, std::vector<Index>& targets) const;
  bool meets(const std::vector<BoundaryArc>& arcs, Index f, const EdgePiece& piece) const;
  double endAlong(Index f, Index h, double end) const;
  void addEdgesAlong(Index f, const EdgePiece& piece, std::vector<Index>& targets) const;

  static Rest restOf(const FaceTransit& transit, Index f);

  Index enteredBy(Index e, int sign) const;
  void cutForAll();
  void rowForAll(Index node, std::vector<Index>& targets) const;
  void enterForAll(Index f, Index node, std::vector<Index>& targets) const;
  Index reached(Index node, const EdgePiece& piece) const;

  std::shared_ptr<const FaceTransit> transit_;
  std::shared_ptr<const ConeTransit> cones_;  ///< null without an error bound
  std::vector<EdgePiece> pieces_;
  std::vector<Place> places_;            ///< pieces edge by edge, along each
  std::vector<std::size_t> offsets_{0};  ///< of the edges, in places_
  std::vector<double> touches_;  ///< of each edge: what the trajectory through its turn, which touches it, goes on to
  std::vector<Index> restSlot_;  ///< of each face, in rests_, or kNone
  std::vector<Rest> rests_;
};

}  // namespace stormfield
