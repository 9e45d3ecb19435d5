#include "maps/transit_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace stormfield {
namespace {

/// Nodes that a thread works on at a time.
constexpr std::size_t kGrain = 256;
/// Fractions of a side (or positions) that are the same but for round-off.
constexpr double kSamePosition = 1e-12;

/// body(i) in parallel; stops soon when the progress is cancelled, and throws then.
template <typename Body>
void eachOf(std::size_t count, Progress* progress, const Body& body) {
  tbb::parallel_for(std::size_t{0}, (count + kGrain - 1) / kGrain, [&](std::size_t block) {
    if (progress != nullptr && progress->cancelled()) return;
    const std::size_t end = std::min(count, (block + 1) * kGrain);
    for (std::size_t i = block * kGrain; i < end; ++i) body(i);
  });
  if (progress != nullptr) progress->check();
}

/// Whether two arcs come within the slack of each other.
bool meet(double begin, double length, const BoundaryArc& arc) {
  constexpr double kSlack = FaceTransit::kSlack;
  for (const double round : {-3.0, 0.0, 3.0}) {
    if (begin + round <= arc.begin + arc.length + kSlack && arc.begin <= begin + round + length + kSlack) return true;
  }
  return false;
}

}  // namespace

TransitMap::TransitMap(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
                       Progress* progress, std::shared_ptr<const ConeTransit> cones)
    : transit_(std::make_shared<const FaceTransit>(std::move(faces), std::move(field))),
      cones_(std::move(cones)),
      interiorSlot_(mesh().faceCount(), kNone) {
  if (cones_) {
    addPiecesOfAllFields();
  } else {
    addPiecesOfField(progress);
  }
  for (Index i = 0; i < pieceCount(); ++i) onEdges_.push_back(onEdge(i));
  if (progress != nullptr) progress->check();
}

/// Cuts each edge at its sign change and each of the two sides of it at its jumps.
void TransitMap::addPiecesOfField(Progress* progress) {
  const auto edgeCount = static_cast<std::size_t>(mesh().edgeCount());
  const auto entered = [&](Index e, int sign) {
    return transit_->edgeFlow(e).along != 0 ? EnteredRegion::none() : enteredBy(e, sign);
  };
  findInteriorNodes(progress);
  std::vector<std::array<Cuts, 2>> cuts(edgeCount);
  eachOf(edgeCount, progress, [&](std::size_t i) {
    const auto e = static_cast<Index>(i);
    const auto [sign, signChange, touchesInside, along] = transit_->edgeFlow(e);
    EdgePiece piece;
    piece.edge = e;
    piece.enters = entered(e, sign);
    piece.to = signChange;
    cut(piece, cuts[i][0]);
    if (signChange == 1.0) return;
    piece.enters = entered(e, -sign);
    piece.from = signChange;
    piece.to = 1.0;
    cut(piece, cuts[i][1]);
  });
  pieces_.reserve(edgeCount + edgeCount / 2);
  tangentExits_.resize(edgeCount);
  for (std::size_t i = 0; i < edgeCount; ++i) {
    const auto e = static_cast<Index>(i);
    const auto [sign, signChange, touchesInside, along] = transit_->edgeFlow(e);
    double from = 0.0;
    for (int half = 0; half < 2; ++half) {
      for (const auto& [to, exitOfFrom, exitOfTo] : cuts[i][half]) {
        pieces_.push_back({e, entered(e, half == 0 ? sign : -sign), 0, from, to, exitOfFrom, exitOfTo});
        from = to;
      }
    }
    offsets_.push_back(pieces_.size());
    if (signChange == 1.0) continue;
    tangentExits_[i] = (sign > 0) == touchesInside ? cuts[i][0].back().exitOfTo : cuts[i][1].front().exitOfFrom;
  }
}

/// sign: of the crossing, +1 into the face of the canonical halfedge, -1 out of it, 0 both ways.
EnteredRegion TransitMap::enteredBy(Index e, int sign) const {
  const Index h = mesh().edgeHalfedge(e), twin = mesh().twin(h);
  if (sign == 0) return EnteredRegion::bothFaces();
  if (sign > 0) return EnteredRegion(TriangleMesh::face(h));
  return twin == kNone ? EnteredRegion::outside() : EnteredRegion(TriangleMesh::face(twin));
}

/// Cuts edges where the fields within the bound begin to cross them both ways. A narrow piece counts as halved.
void TransitMap::addPiecesOfAllFields() {
  for (Index e = 0; e < mesh().edgeCount(); ++e) {
    std::vector<double> ends = cones_->signChanges(e);
    ends.push_back(1.0);
    double from = 0.0;
    for (const double to : ends) {
      EdgePiece piece;
      piece.edge = e;
      piece.enters = enteredBy(e, cones_->crossingSign(e, from, to));
      piece.level = -std::ilogb(to - from);
      piece.from = from;
      piece.to = to;
      pieces_.push_back(piece);
      from = to;
    }
    offsets_.push_back(pieces_.size());
  }
}

TransitMap TransitMap::withinEpsilon(std::shared_ptr<const ConeTransit> cones) const {
  TransitMap result = *this;
  result.cones_ = std::move(cones);
  tbb::parallel_for(std::size_t{0}, pieces_.size(), [&](std::size_t i) {
    EdgePiece& piece = result.pieces_[i];
    piece.enters = enteredBy(piece.edge, result.cones_->crossingSign(piece.edge, piece.from, piece.to));
  });
  for (PieceOnEdge& at : result.onEdges_) at = result.onEdge(at.piece);
  return result;
}

void TransitMap::findInteriorNodes(Progress* progress) {
  std::vector<Index> faces;
  for (Index f = 0; f < mesh().faceCount(); ++f) {
    if (transit_->isCoarse(f) || transit_->poincare()[f] == 0) continue;
    interiorSlot_[f] = static_cast<Index>(faces.size());
    faces.push_back(f);
  }
  interiorNodes_.resize(faces.size());
  tbb::parallel_for(
      std::size_t{0}, faces.size(),
      [&](std::size_t i) {
        if (progress == nullptr || !progress->cancelled()) interiorNodes_[i] = interiorNodeOf(*transit_, faces[i]);
      },
      tbb::simple_partitioner());
  if (progress != nullptr) progress->check();
}

TransitMap::InteriorNode TransitMap::interiorNodeOf(const FaceTransit& transit, Index f) {
  const bool isSaddle = transit.poincare()[f] < 0;
  // Arcs on which trajectories stay; at a saddle, single ones, where the exits jump.
  const auto stayingArcs = [&](const std::vector<ContinuousArc>& arcs) {
    std::vector<BoundaryArc> result;
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      const auto& [entry, exitOfBegin, exitOfEnd] = arcs[i];
      if (!exitOfBegin.exists() && !exitOfEnd.exists()) result.push_back(entry);
      const double end = std::fmod(entry.begin + entry.length, 3.0);
      const bool jumps = std::any_of(arcs.begin(), arcs.end(), [&](const ContinuousArc& other) {
        return &other != &arcs[i] && std::abs(other.entry.begin - end) < kSamePosition;
      });
      if (isSaddle && jumps) result.push_back({end, 0.0});
    }
    return result;
  };
  InteriorNode node;
  node.entry = transit.continuousArcs(f);
  node.toFixedPoint = stayingArcs(node.entry);
  node.fromFixedPoint = stayingArcs(transit.continuousArcs(f, Direction::Backward));
  // At a jump the exit goes to its limit as a power less than 1 of the distance: to where trajectories from a saddle
  // leave, or to where one touches the boundary from inside. What bisection has found is moved on to the nearest such
  // limit within kNear (in sides).
  constexpr double kNear = 0.1;
  const auto moveToLimit = [&](ExitPosition& exit, double at, double onwards) {
    const auto touches = [&](const ContinuousArc& arc) {
      const double distance = std::remainder(arc.entry.begin - at, 3.0);
      return std::abs(distance) < kSamePosition ||
             std::abs(std::remainder(distance + arc.entry.length, 3.0)) < kSamePosition;
    };
    const bool jumps = std::count_if(node.entry.begin(), node.entry.end(), touches) > 1;
    if (!jumps || !exit.exists()) return;
    const BoundaryArc arc = transit.exitArcAt(f, *exit);
    std::vector<double> limits;
    for (const double end : {arc.begin, std::fmod(arc.begin + arc.length, 3.0)}) {
      if (transit.touchesAt(f, end)) limits.push_back(end);
    }
    for (const BoundaryArc& from : node.fromFixedPoint) {
      if (isSaddle && transit.isSameArc(f, from.begin, exit)) limits.push_back(from.begin);
    }
    double nearest = kNear, found = *exit;
    for (const double limit : limits) {
      const double distance = onwards * std::remainder(limit - *exit, 3.0);
      if (distance < 0.0 || distance >= nearest) continue;
      nearest = distance;
      found = limit;
    }
    exit = found;
  };
  for (ContinuousArc& arc : node.entry) {
    moveToLimit(arc.exitOfBegin, arc.entry.begin,
                1.0);  // exits go clockwise as entries go counter-clockwise
    moveToLimit(arc.exitOfEnd, arc.entry.begin + arc.entry.length, -1.0);
  }
  return node;
}

double TransitMap::positionIn(Index f, Index edge, double fraction) const {
  const Index h = mesh().edgeHalfedge(edge);
  if (TriangleMesh::face(h) == f) return TriangleMesh::corner(h) + fraction;
  return TriangleMesh::corner(mesh().twin(h)) + 1.0 - fraction;
}

/// Cuts a part of an edge at the jumps in faces with a fixed point. In other faces pieces may hold jumps.
void TransitMap::cut(const EdgePiece& piece, Cuts& cuts) const {
  if (!piece.enters.isFace() || transit_->isCoarse(piece.enters.face())) {
    cuts.push_back({piece.to, kNoExit, kNoExit});
    return;
  }
  const Index f = piece.enters.face();
  if (interiorSlot_[f] != kNone) return cutAtJumps(piece, interiorNodes_[interiorSlot_[f]], cuts);
  const double from = positionIn(f, piece.edge, piece.from), to = positionIn(f, piece.edge, piece.to);
  cuts.push_back({piece.to, transit_->exitLimit(f, from, to), transit_->exitLimit(f, to, from)});
}

void TransitMap::cutAtJumps(const EdgePiece& piece, const InteriorNode& node, Cuts& cuts) const {
  const Index f = piece.enters.face();
  const double a = positionIn(f, piece.edge, piece.from), b = positionIn(f, piece.edge, piece.to);
  const double begin = std::min(a, b), end = std::max(a, b);
  std::vector<ContinuousArc> found;
  for (const ContinuousArc& arc : node.entry) {
    for (const int round : {-3, 0, 3}) {
      const double from = std::max(begin, arc.entry.begin + round);
      const double to = std::min(end, arc.entry.begin + round + arc.entry.length);
      if (to - from < kSamePosition) continue;
      found.push_back({{from, to - from},
                       from > begin ? arc.exitOfBegin : transit_->exitLimit(f, from, to),
                       to < end ? arc.exitOfEnd : transit_->exitLimit(f, to, from)});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const ContinuousArc& p, const ContinuousArc& q) { return p.entry.begin < q.entry.begin; });
  if (found.empty()) found.push_back({{begin, end - begin}, kNoExit, kNoExit});
  if (a > b) std::reverse(found.begin(), found.end());
  for (const auto& [entry, exitOfBegin, exitOfEnd] : found) {
    const double last = std::abs((a < b ? entry.begin + entry.length : entry.begin) - a) + piece.from;
    cuts.push_back({last, a < b ? exitOfBegin : exitOfEnd, a < b ? exitOfEnd : exitOfBegin});
  }
  cuts.back().to = piece.to;
}

std::vector<std::size_t> TransitMap::halve(const std::vector<Index>& nodes, Progress* progress) {
  const std::size_t count = nodes.size();
  std::vector<ExitPosition> exitsOfMiddles(count);
  eachOf(cones_ ? 0 : count, progress, [&](std::size_t i) {
    const EdgePiece& piece = this->piece(nodes[i]);
    if (!piece.enters.isFace() || transit_->isCoarse(piece.enters.face())) return;
    const Index f = piece.enters.face();
    exitsOfMiddles[i] = transit_->exitOf(f, positionIn(f, piece.edge, 0.5 * (piece.from + piece.to)));
  });
  std::vector<std::size_t> firsts;
  std::vector<Index> secondOf(pieces_.size(), kNone);
  for (std::size_t i = 0; i < count; ++i) {
    const Index at = nodes[i] - mesh().faceCount();
    EdgePiece& first = pieces_[at];
    const double middle = 0.5 * (first.from + first.to);
    if (!(middle > first.from && middle < first.to)) continue;
    ++first.level;
    EdgePiece second = first;
    first.to = second.from = middle;
    first.exitOfTo = second.exitOfFrom = exitsOfMiddles[i];
    if (cones_) {
      first.enters = enteredBy(first.edge, cones_->crossingSign(first.edge, first.from, first.to));
      second.enters = enteredBy(second.edge, cones_->crossingSign(second.edge, second.from, second.to));
    }
    secondOf[at] = pieceCount();
    firsts.push_back(i);
    pieces_.push_back(second);
  }
  const std::vector<PieceOnEdge> before = std::move(onEdges_);
  onEdges_.clear();
  onEdges_.reserve(pieces_.size());
  std::size_t begin = 0;
  for (std::size_t e = 1; e < offsets_.size(); ++e) {
    for (; begin < offsets_[e]; ++begin) {
      const Index first = before[begin].piece, second = secondOf[first];
      onEdges_.push_back(second == kNone ? before[begin] : onEdge(first));
      if (second != kNone) onEdges_.push_back(onEdge(second));
    }
    offsets_[e] = onEdges_.size();
  }
  return firsts;
}

/// visit(node, piece) for the pieces within the slack of an arc over which flow leaves a face.
template <typename Visit>
void TransitMap::eachExit(Index f, const BoundaryArc& arc, const Visit& visit) const {
  // With an error bound, the extreme fields are rotated to spare already (cone_transit.h).
  constexpr double kSlack = FaceTransit::kSlack;
  const BoundaryArc reach = cones_ || arc.length >= kWholeBoundary.length
                                ? BoundaryArc{arc.begin - kSlack, arc.length + 2.0 * kSlack}
                                : transit_->widened(f, arc);
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    const Index e = mesh().edge(h);
    const bool canonical = mesh().edgeHalfedge(e) == h;
    for (const int round : {-3, 0, 3}) {
      const double side = TriangleMesh::corner(h) + round;
      double from = reach.begin - side;
      double to = reach.begin + reach.length - side;
      if (from > 1.0 || to < 0.0) continue;
      if (!canonical) {
        std::swap(from, to);
        from = 1.0 - from;
        to = 1.0 - to;
      }
      const PieceOnEdge* const first = onEdges_.data() + offsets_[e];
      const PieceOnEdge* const end = onEdges_.data() + offsets_[e + 1];
      const PieceOnEdge* at =
          std::lower_bound(first, end, from, [](const PieceOnEdge& p, double fraction) { return p.to < fraction; });
      for (; at != end && (at == first || at[-1].to <= to); ++at) {
        const bool isExit = at->enters != EnteredRegion(f) && at->enters != EnteredRegion::none();
        if (isExit) visit(nodeOf(at->piece), pieces_[at->piece]);
      }
    }
  }
}

bool TransitMap::meetsAny(const std::vector<BoundaryArc>& arcs, Index f, const EdgePiece& piece) const {
  const double c = positionIn(f, piece.edge, piece.from), d = positionIn(f, piece.edge, piece.to);
  return std::any_of(arcs.begin(), arcs.end(),
                     [&](const BoundaryArc& arc) { return meet(std::min(c, d), std::abs(d - c), arc); });
}

// Rows of the field
// --------------------------------------------------------------------------------------------------

void TransitMap::row(Index node, std::vector<Index>& targets) const {
  targets.clear();
  if (cones_) {
    addRowForAllFields(node, targets);
  } else if (node < mesh().faceCount()) {
    addInteriorRow(node, targets);
  } else if (node < outside()) {
    addPieceRow(piece(node), targets);
  }
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
}

void TransitMap::addInteriorRow(Index f, std::vector<Index>& targets) const {
  if (!transit_->holdsFixedPoint(f)) return;
  targets.push_back(f);
  const Index slot = interiorSlot_[f];
  eachExit(f, kWholeBoundary, [&](Index exit, const EdgePiece& piece) {
    if (slot == kNone || meetsAny(interiorNodes_[slot].fromFixedPoint, f, piece)) targets.push_back(exit);
  });
}

void TransitMap::addPieceRow(const EdgePiece& piece, std::vector<Index>& targets) const {
  const Index h = mesh().edgeHalfedge(piece.edge), twin = mesh().twin(h);
  if (piece.enters == EnteredRegion::outside()) {
    targets.push_back(outside());
  } else if (piece.enters.isFace()) {
    addTargetsInFace(piece.enters.face(), piece, targets);
  } else if (piece.enters == EnteredRegion::bothFaces()) {
    addTargetsInFace(TriangleMesh::face(h), piece, targets);
    if (twin == kNone) {
      targets.push_back(outside());
    } else {
      addTargetsInFace(TriangleMesh::face(twin), piece, targets);
    }
  } else {  // flow runs along the edge
    for (const Index side : {h, twin}) {
      if (side == kNone) continue;
      const Index f = TriangleMesh::face(side);
      eachExit(f, {endOfFlowAlong(f, side, 1.0), 0.0}, [&](Index exit, const EdgePiece&) { targets.push_back(exit); });
    }
  }
}

/// Adds what a piece leads to in a face that flow enters through it.
void TransitMap::addTargetsInFace(Index f, const EdgePiece& piece, std::vector<Index>& targets) const {
  addEdgesAlong(f, piece, targets);
  const bool someStay = !piece.exitOfFrom.exists() || !piece.exitOfTo.exists();
  const bool allStay = piece.exitOfFrom == piece.exitOfTo && someStay;
  const Index slot = interiorSlot_[f];
  // At a saddle single trajectories alone stay: a whole end that does has been lost by the tracing.
  const bool isLost = someStay && transit_->poincare()[f] < 0;
  if (isLost || (slot == kNone && someStay)) {
    if (transit_->holdsFixedPoint(f)) targets.push_back(f);
    eachExit(f, kWholeBoundary, [&](Index node, const EdgePiece&) { targets.push_back(node); });
    return;
  }
  if (slot != kNone && (someStay || meetsAny(interiorNodes_[slot].toFixedPoint, f, piece))) targets.push_back(f);
  if (!allStay) addExits(f, piece, targets);
}

/// Adds the pieces over the arc between the exits of a piece's two ends: over one arc, or over two with a jump between.
void TransitMap::addExits(Index f, const EdgePiece& piece, std::vector<Index>& targets) const {
  double begin = positionIn(f, piece.edge, piece.from), end = positionIn(f, piece.edge, piece.to);
  ExitPosition exitOfBegin = piece.exitOfFrom, exitOfEnd = piece.exitOfTo;
  if (begin > end) {
    std::swap(begin, end);
    std::swap(exitOfBegin, exitOfEnd);
  }
  std::array<BoundaryArc, 2> images;
  if (const auto arc = transit_->commonExitArc(f, exitOfBegin, exitOfEnd)) {
    // By position within the arc, because round-off may change the order of two exits.
    const auto fromBegin = [&](double position) {
      const double distance = arcLength(arc->begin, position);
      return distance > 0.5 * (3.0 + arc->length) ? distance - 3.0 : distance;
    };
    const double a = fromBegin(*exitOfBegin), b = fromBegin(*exitOfEnd);
    images.fill({arc->begin + std::min(a, b), std::abs(a - b)});
  } else {
    // Trajectories do not cross, so that exits go clockwise as the piece goes counter-clockwise.
    const double first = exitOfEnd.exists() ? *exitOfEnd : end;
    const double last = exitOfBegin.exists() ? *exitOfBegin : begin;
    const auto [before, after] = jumpBetween(f, first, last);
    images = {BoundaryArc{first, arcLength(first, before)}, BoundaryArc{after, arcLength(after, last)}};
  }
  for (const BoundaryArc& image : images) {
    eachExit(f, image, [&](Index node, const EdgePiece&) { targets.push_back(node); });
  }
}

/// The exit of the trajectory that touches the boundary of a face from inside at a position; none where none touches.
ExitPosition TransitMap::tangentExit(Index f, double position) const {
  if (!transit_->touchesAt(f, position)) return kNoExit;
  return tangentExits_[mesh().edge(TriangleMesh::halfedge(f, static_cast<int>(std::fmod(position, 3.0))))];
}

/// Where exits jump from one arc of exit to the next, between a position in each: at an end of one of the arcs a
/// trajectory touches the boundary. A jump that is not known may be anywhere between the two positions.
std::pair<double, double> TransitMap::jumpBetween(Index f, double first, double last) const {
  const BoundaryArc from = transit_->exitArcAt(f, first), to = transit_->exitArcAt(f, last);
  const ExitPosition onwards = tangentExit(f, from.begin + from.length), back = tangentExit(f, to.begin);
  if (onwards.exists() && transit_->isSameArc(f, onwards, last)) return {from.begin + from.length, *onwards};
  if (back.exists() && transit_->isSameArc(f, back, first)) return {*back, to.begin};
  return {last, last};
}

/// Where the flow along halfedge h of a face begins (end: 0) or ends (1).
double TransitMap::endOfFlowAlong(Index f, Index h, double end) const {
  const Index e = mesh().edge(h);
  return positionIn(f, e, transit_->edgeFlow(e).along > 0 ? end : 1.0 - end);
}

/// Adds the edges that flow runs along from where a piece enters a face.
void TransitMap::addEdgesAlong(Index f, const EdgePiece& piece, std::vector<Index>& targets) const {
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    const Index e = mesh().edge(h);
    if (transit_->edgeFlow(e).along == 0 || !meetsAny({{endOfFlowAlong(f, h, 0.0), 0.0}}, f, piece)) continue;
    targets.push_back(nodeOf(onEdges_[offsets_[e]].piece));
  }
}

// Rows of all fields within an error bound ---------------------------------------------------------------------------

void TransitMap::addRowForAllFields(Index node, std::vector<Index>& targets) const {
  if (node < mesh().faceCount()) {
    if (!cones_->mayHoldFixedPoint(node)) return;
    targets.push_back(node);
    eachExit(node, kWholeBoundary,
             [&](Index exit, const EdgePiece& over) { targets.push_back(nodeBeyond(exit, over)); });
  } else if (node < outside()) {
    const EdgePiece& piece = this->piece(node);
    const Index h = mesh().edgeHalfedge(piece.edge), twin = mesh().twin(h);
    if (piece.enters == EnteredRegion::outside()) {
      targets.push_back(outside());
    } else if (piece.enters != EnteredRegion::bothFaces()) {
      addTargetsForAllFields(piece.enters.face(), node, targets);
    } else {
      addTargetsForAllFields(TriangleMesh::face(h), node, targets);
      if (twin != kNone) addTargetsForAllFields(TriangleMesh::face(twin), node, targets);
    }
  }
}

/// Adds what a piece leads to, in some field within the bound, in a face that flow enters through it. Without a fixed
/// point in the face, a piece leads to itself only by way of others.
void TransitMap::addTargetsForAllFields(Index f, Index node, std::vector<Index>& targets) const {
  if (cones_->mayHoldFixedPoint(f)) {
    targets.push_back(f);  // which leads to all exits
    return;
  }
  const EdgePiece& piece = this->piece(node);
  const double a = positionIn(f, piece.edge, piece.from), b = positionIn(f, piece.edge, piece.to);
  const double begin = std::min(a, b), end = std::max(a, b);
  const int side = std::min(2, static_cast<int>(0.5 * (begin + end)));
  for (const BoundaryArc& arc : cones_->exitArcs(f, side, begin - side, end - side)) {
    eachExit(f, arc, [&](Index exit, const EdgePiece& over) {
      if (exit != node) targets.push_back(nodeBeyond(exit, over));
    });
  }
}

/// The node that flow reaches over a piece. What leaves over the surface's boundary does not come back over it, also
/// where other flow enters.
Index TransitMap::nodeBeyond(Index node, const EdgePiece& piece) const {
  return mesh().twin(mesh().edgeHalfedge(piece.edge)) == kNone ? outside() : node;
}

// The whole map
// ------------------------------------------------------------------------------------------------------

bool TransitMap::isSettled(Index node) const {
  if (!isPiece(node)) return true;
  const EdgePiece& piece = this->piece(node);
  if (!cones_) return !piece.enters.isFace() || transit_->isCoarse(piece.enters.face());
  const Index h = mesh().edgeHalfedge(piece.edge), twin = mesh().twin(h);
  return cones_->mayHoldFixedPoint(TriangleMesh::face(h)) &&
         (twin == kNone || cones_->mayHoldFixedPoint(TriangleMesh::face(twin)));
}

CombinatorialMap TransitMap::map(Progress* progress) const {
  std::vector<Index> nodes, position(static_cast<std::size_t>(outside()) + 1);
  nodes.reserve(position.size());
  eachNode([&](Index node) { nodes.push_back(node); });
  nodes.push_back(outside());
  std::iota(position.begin(), position.end(), 0);
  return {graphByPosition(nodes, position, progress)};
}

DirectedGraph TransitMap::graphAmong(const std::vector<Index>& nodes, Progress* progress) const {
  std::vector<Index> position(static_cast<std::size_t>(outside()) + 1, kNone);
  for (std::size_t i = 0; i < nodes.size(); ++i) position[nodes[i]] = static_cast<Index>(i);
  return graphByPosition(nodes, position, progress);
}

/// position: of each node of the map among the nodes, or kNone.
DirectedGraph TransitMap::graphByPosition(const std::vector<Index>& nodes, const std::vector<Index>& position,
                                          Progress* progress) const {
  std::vector<std::vector<Index>> blocks((nodes.size() + kGrain - 1) / kGrain);
  const auto eachBlock = [&](const auto& body) {
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
      if (progress != nullptr && progress->cancelled()) return;
      body(blocks[b], b * kGrain, std::min(nodes.size(), (b + 1) * kGrain));
    });
    if (progress != nullptr) progress->check();
  };
  DirectedGraph graph;
  graph.offsets.assign(nodes.size() + 1, 0);
  eachBlock([&](std::vector<Index>& targets, std::size_t begin, std::size_t end) {
    std::vector<Index> row;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t before = targets.size();
      this->row(nodes[i], row);
      for (const Index target : row) {
        if (position[target] != kNone) targets.push_back(position[target]);
      }
      std::sort(targets.begin() + static_cast<std::ptrdiff_t>(before), targets.end());
      graph.offsets[static_cast<std::size_t>(position[nodes[i]]) + 1] = targets.size() - before;
    }
  });
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
  graph.targets.resize(graph.offsets.back());
  eachBlock([&](std::vector<Index>& targets, std::size_t begin, std::size_t end) {
    auto from = targets.begin();
    for (std::size_t i = begin; i < end; ++i) {
      const Index at = position[nodes[i]];
      const auto length = static_cast<std::ptrdiff_t>(graph.offsets[at + 1] - graph.offsets[at]);
      std::copy(from, from + length, graph.targets.begin() + static_cast<std::ptrdiff_t>(graph.offsets[at]));
      from += length;
    }
    targets = {};
  });
  return graph;
}

void TransitMap::appendFaces(Index node, std::vector<Index>& faces) const {
  if (node < mesh().faceCount()) {
    faces.push_back(node);
  } else if (node < outside()) {
    const EdgePiece& piece = this->piece(node);
    if (piece.enters.isFace()) faces.push_back(piece.enters.face());
    if (piece.enters != EnteredRegion::bothFaces() && piece.enters != EnteredRegion::none()) return;
    const Index h = mesh().edgeHalfedge(piece.edge), twin = mesh().twin(h);
    faces.push_back(TriangleMesh::face(h));
    if (twin != kNone) faces.push_back(TriangleMesh::face(twin));
  }
}

}  // namespace stormfield
