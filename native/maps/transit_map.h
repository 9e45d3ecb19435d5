// The transit map: a combinatorial map whose nodes are pieces of edges, so that it remembers where flow enters a face.
// It refines the geometry-based map (thesis 2.4.2, 6.2), in the way in which the transition graph of Szymczak and Zhang
// 2012 ("Robust Morse decompositions of piecewise constant vector fields") does for fields that are constant on faces.
//
// Every edge is cut into pieces that flow crosses in one direction. A piece leads to the pieces over which what enters
// through it leaves the next face. A face with a fixed point has an interior node, which stands for its inside: what
// stays in the face leads to it, and it leads to what comes from there. The transit map of a face is monotone
// (face_transit.h), so that the image of a piece lies on the arc between those of its two ends. It is enclosed to a
// slack of round-off size, not padded by an estimate of what happens between samples. Halving a piece halves its image:
// what tau maps resolve by longer times, halving resolves by crossing one face at a time. A row depends on its own
// piece alone, so that any order of halving leads to the same map.
//
// Faces with a fixed point on an edge or at a vertex are known by the directions across their edges only: whatever
// enters leads to the interior node and to all exits. An edge that the flow runs along is one piece, a trajectory that
// none crosses: what enters a face beside its first end leads to it, and it leads to what leaves its two faces beside
// its other end.
//
// With an error bound epsilon > 0 the map holds for every field within it (cone_transit.h). A piece that some of these
// fields cross one way and some the other enters both faces, a piece leads to whatever lies over its exit arcs, and a
// face that may hold a fixed point is known by its exits only. Rows grow with epsilon as long as the pieces stay.
//
//   const auto flatFaces = std::make_shared<const FlatFaces>(field.charts);
//   const auto shared = std::make_shared<const VectorField>(field);
//   TransitMap map(flatFaces, shared);
//   map.halve({map.nodeOf(0), map.nodeOf(1)});
//   const CombinatorialMap whole = map.map();  // interior nodes of the faces, pieces, outside
//   const TransitMap bounded = map.withinEpsilon(std::make_shared<const ConeTransit>(flatFaces, shared, 0.1));
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "maps/combinatorial_map.h"
#include "maps/detail/cone_transit.h"
#include "maps/detail/face_transit.h"

namespace stormfield {

/// What flow enters over a piece of an edge: a face, or one of three cases without a single face. As large as an index.
class EnteredRegion {
 public:
  /// Over the boundary of the surface.
  constexpr EnteredRegion() = default;
  constexpr explicit EnteredRegion(Index face) : code_(face) {}
  static constexpr EnteredRegion outside() { return EnteredRegion(); }
  /// Flow crosses the piece both ways.
  static constexpr EnteredRegion bothFaces() { return EnteredRegion(kBothFaces); }
  /// Flow runs along the edge, and crosses it nowhere.
  static constexpr EnteredRegion none() { return EnteredRegion(kNoRegion); }

  constexpr bool isFace() const { return code_ >= 0; }
  constexpr Index face() const { return code_; }
  constexpr bool operator==(const EnteredRegion&) const = default;

 private:
  static constexpr Index kOutside = -1, kBothFaces = -2, kNoRegion = -3;
  Index code_ = kOutside;
};

/// A piece of an edge, from one fraction of its canonical halfedge to another.
struct EdgePiece {
  Index edge = kNone;
  EnteredRegion enters;
  int level = 0;  ///< halvings
  double from = 0.0, to = 1.0;
  /// Where the trajectories through its ends leave the face that they enter, as limits from inside the piece.
  ExitPosition exitOfFrom, exitOfTo;
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
  /// Nodes: the interior node of each face, then the pieces, then outside.
  Index pieceCount() const { return static_cast<Index>(pieces_.size()); }
  Index nodeOf(Index piece) const { return mesh().faceCount() + piece; }
  bool isPiece(Index node) const { return node >= mesh().faceCount() && node < outside(); }
  const EdgePiece& piece(Index node) const { return pieces_[node - mesh().faceCount()]; }
  Index outside() const { return mesh().faceCount() + pieceCount(); }

  /// Halves the pieces of some nodes. The first half keeps the piece's node, the second gets a new one at the end.
  /// Returns for each new node the position in `nodes` of its first half. Throws Cancelled, which leaves the map as it
  /// was.
  std::vector<std::size_t> halve(const std::vector<Index>& nodes, Progress* progress = nullptr);

  /// The nodes that a node leads to, ascending.
  void row(Index node, std::vector<Index>& targets) const;
  CombinatorialMap map(Progress* progress = nullptr) const;
  /// Visits all nodes but outside: interior nodes, then the pieces edge by edge, along each. The numbers of two halves
  /// are far apart; in this order, neighbours on the surface come together and work on them stays in the cache.
  template <typename Visit>
  void eachNode(const Visit& visit) const {
    for (Index f = 0; f < mesh().faceCount(); ++f) visit(f);
    for (const PieceOnEdge& at : onEdges_) visit(nodeOf(at.piece));
  }
  /// The edges among some nodes, by their positions in the list.
  DirectedGraph graphAmong(const std::vector<Index>& nodes, Progress* progress) const;
  /// Appends the face of an interior node, or the faces that flow enters through a piece.
  void appendFaces(Index node, std::vector<Index>& faces) const;
  /// Per face whether it can hold a fixed point of a field within the bound.
  const std::vector<char>& fixedPointFaces() const {
    return cones_ ? cones_->fixedPointFaces() : transit_->fixedPointFaces();
  }
  /// Whether halving changes nothing: the node is no piece, or flow enters no face through it but such as are known by
  /// their exits only.
  bool isSettled(Index node) const;
  std::size_t bytes() const { return sizeof(EdgePiece) * pieces_.capacity(); }

 private:
  /// The interior node of a face with a fixed point inside: the continuous parts of the face's arcs of entry, the arcs
  /// over which trajectories enter that stay, and those over which trajectories leave that come from the fixed point
  /// (single positions at a saddle).
  struct InteriorNode {
    std::vector<ContinuousArc> entry;
    std::vector<BoundaryArc> toFixedPoint, fromFixedPoint;
  };
  /// The end of a piece, and the exits of the piece's two ends.
  struct Cut {
    double to;
    ExitPosition exitOfFrom, exitOfTo;
  };
  using Cuts = std::vector<Cut>;
  /// What a search along an edge reads of a piece, kept together with its neighbours on the edge: the pieces themselves
  /// are far apart.
  struct PieceOnEdge {
    double to;
    Index piece;
    EnteredRegion enters;
  };

  PieceOnEdge onEdge(Index piece) const { return {pieces_[piece].to, piece, pieces_[piece].enters}; }
  DirectedGraph graphByPosition(const std::vector<Index>& nodes, const std::vector<Index>& position,
                                Progress* progress) const;
  double positionIn(Index f, Index edge, double fraction) const;
  EnteredRegion enteredBy(Index e, int sign) const;
  void addPiecesOfField(Progress* progress);
  void addPiecesOfAllFields();
  void findInteriorNodes(Progress* progress);
  static InteriorNode interiorNodeOf(const FaceTransit& transit, Index f);
  void cut(const EdgePiece& piece, Cuts& cuts) const;
  void cutAtJumps(const EdgePiece& piece, const InteriorNode& node, Cuts& cuts) const;

  template <typename Visit>
  void eachExit(Index f, const BoundaryArc& arc, const Visit& visit) const;
  bool meetsAny(const std::vector<BoundaryArc>& arcs, Index f, const EdgePiece& piece) const;

  void addInteriorRow(Index f, std::vector<Index>& targets) const;
  void addPieceRow(const EdgePiece& piece, std::vector<Index>& targets) const;
  void addTargetsInFace(Index f, const EdgePiece& piece, std::vector<Index>& targets) const;
  void addExits(Index f, const EdgePiece& piece, std::vector<Index>& targets) const;
  void addEdgesAlong(Index f, const EdgePiece& piece, std::vector<Index>& targets) const;
  double endOfFlowAlong(Index f, Index h, double end) const;
  ExitPosition tangentExit(Index f, double position) const;
  std::pair<double, double> jumpBetween(Index f, double first, double last) const;

  void addRowForAllFields(Index node, std::vector<Index>& targets) const;
  void addTargetsForAllFields(Index f, Index node, std::vector<Index>& targets) const;
  Index nodeBeyond(Index node, const EdgePiece& piece) const;

  std::shared_ptr<const FaceTransit> transit_;
  std::shared_ptr<const ConeTransit> cones_;  ///< null without an error bound
  std::vector<EdgePiece> pieces_;
  std::vector<PieceOnEdge> onEdges_;        ///< edge by edge, along each
  std::vector<std::size_t> offsets_{0};     ///< of the edges, in onEdges_
  std::vector<ExitPosition> tangentExits_;  ///< of each edge, of the trajectory that touches it at its sign change
  std::vector<Index> interiorSlot_;         ///< of each face, in interiorNodes_, or kNone
  std::vector<InteriorNode> interiorNodes_;
};

}  // namespace stormfield
