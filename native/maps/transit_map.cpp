#include "maps/transit_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace stormfield {
namespace {

/// The whole boundary of a face.
constexpr BoundaryArc kAround{0.0, 3.0};
/// Work of one thread at a time.
constexpr std::size_t kGrain = 256;

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

/// Whether two parts of a circle of length 3 come within the slack of each other.
bool meet(double begin, double length, const BoundaryArc& arc) {
  constexpr double kSlack = FaceTransit::kSlack;
  for (const double turn : {-3.0, 0.0, 3.0}) {
    if (begin + turn <= arc.begin + arc.length + kSlack && arc.begin <= begin + turn + length + kSlack) return true;
  }
  return false;
}

}  // namespace

TransitMap::TransitMap(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
                       Progress* progress, std::shared_ptr<const ConeTransit> cones)
    : transit_(std::make_shared<const FaceTransit>(std::move(faces), std::move(field))),
      cones_(std::move(cones)),
      restSlot_(mesh().faceCount(), kNone) {
  if (cones_) {
    cutForAll();
    if (progress != nullptr) progress->check();
    return;
  }
  const auto edgeCount = static_cast<std::size_t>(mesh().edgeCount());
  const auto entered = [&](Index e, int sign) {
    return transit_->edgeFlow(e).along != 0 ? EdgePiece::kAlong : enteredBy(e, sign);
  };
  findRests(progress);
  // Each edge has one part or two, each of these the cuts at its jumps.
  std::vector<std::array<Cuts, 2>> cuts(edgeCount);
  eachOf(edgeCount, progress, [&](std::size_t i) {
    const auto e = static_cast<Index>(i);
    const auto [sign, turn, touchesWithin, along] = transit_->edgeFlow(e);
    EdgePiece piece;
    piece.edge = e;
    piece.enters = entered(e, sign);
    piece.to = turn;
    cut(piece, cuts[i][0]);
    if (turn == 1.0) return;
    piece.enters = entered(e, -sign);
    piece.from = turn;
    piece.to = 1.0;
    cut(piece, cuts[i][1]);
  });
  pieces_.reserve(edgeCount + edgeCount / 2);
  for (std::size_t i = 0; i < edgeCount; ++i) {
    const auto e = static_cast<Index>(i);
    double from = 0.0;
    for (int part = 0; part < 2; ++part) {
      const int sign = transit_->edgeFlow(e).sign;
      for (const auto& [to, imageFrom, imageTo] : cuts[i][part]) {
        pieces_.push_back({e, entered(e, part == 0 ? sign : -sign), 0, from, to, imageFrom, imageTo});
        from = to;
      }
    }
    offsets_.push_back(pieces_.size());
  }
  for (Index i = 0; i < pieceCount(); ++i) places_.push_back(placeOf(i));
  touches_.assign(edgeCount, FaceTransit::kRest);
  for (std::size_t i = 0; i < edgeCount; ++i) {
    const auto [sign, turn, within, along] = transit_->edgeFlow(static_cast<Index>(i));
    if (turn == 1.0) continue;
    touches_[i] = (sign > 0) == within ? cuts[i][0].back().imageTo : cuts[i][1].front().imageFrom;
  }
}

/// What flow enters over an edge that it crosses along its canonical halfedge into the face (1), out of it, or both
/// ways.
Index TransitMap::enteredBy(Index e, int sign) const {
  const Index h = mesh().edgeHalfedge(e), twin = mesh().twin(h);
  if (sign == 0) return EdgePiece::kBothFaces;
  if (sign > 0) return TriangleMesh::face(h);
  return twin == kNone ? EdgePiece::kOutside : TriangleMesh::face(twin);
}

/// Edges are cut where the fields within the bound begin to cross them both ways. What is narrow counts as halved.
void TransitMap::cutForAll() {
  for (Index e = 0; e < mesh().edgeCount(); ++e) {
    std::vector<double> ends = cones_->turns(e);
    ends.push_back(1.0);
    double from = 0.0;
    for (const double to : ends) {
      pieces_.push_back({e, enteredBy(e, cones_->crossing(e, from, to)), -std::ilogb(to - from), from, to});
      from = to;
    }
    offsets_.push_back(pieces_.size());
  }
  for (Index i = 0; i < pieceCount(); ++i) places_.push_back(placeOf(i));
}

TransitMap TransitMap::withinEpsilon(std::shared_ptr<const ConeTransit> cones) const {
  TransitMap result = *this;
  result.cones_ = std::move(cones);
  tbb::parallel_for(std::size_t{0}, pieces_.size(), [&](std::size_t i) {
    EdgePiece& piece = result.pieces_[i];
    piece.enters = enteredBy(piece.edge, result.cones_->crossing(piece.edge, piece.from, piece.to));
  });
  for (Place& place : result.places_) place = result.placeOf(place.piece);
  return result;
}

void TransitMap::findRests(Progress* progress) {
  std::vector<Index> resting;
  for (Index f = 0; f < mesh().faceCount(); ++f) {
    if (transit_->isCoarse(f) || transit_->poincare()[f] == 0) continue;
    restSlot_[f] = static_cast<Index>(resting.size());
    resting.push_back(f);
  }
  rests_.resize(resting.size());
  tbb::parallel_for(
      std::size_t{0}, resting.size(),
      [&](std::size_t i) {
        if (progress == nullptr || !progress->cancelled()) rests_[i] = restOf(*transit_, resting[i]);
      },
      tbb::simple_partitioner());
  if (progress != nullptr) progress->check();
}

TransitMap::Rest TransitMap::restOf(const FaceTransit& transit, Index f) {
  const bool isSaddle = transit.poincare()[f] < 0;
  const auto resting = [&](const std::vector<ContinuousArc>& parts) {
    std::vector<BoundaryArc> arcs;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto& [entry, imageOfBegin, imageOfEnd] = parts[i];
      if (imageOfBegin == FaceTransit::kRest && imageOfEnd == FaceTransit::kRest) arcs.push_back(entry);
      const double end = std::fmod(entry.begin + entry.length, 3.0);
      const bool jumps = std::any_of(parts.begin(), parts.end(), [&](const ContinuousArc& p) {
        return &p != &parts[i] && std::abs(p.entry.begin - end) < 1e-12;
      });
      if (isSaddle && jumps) arcs.push_back({end, 0.0});
    }
    return arcs;
  };
  Rest rest;
  rest.parts = transit.parts(f);
  rest.in = resting(rest.parts);
  rest.out = resting(transit.parts(f, Direction::Backward));
  // Slowly do images come near to their limits: where trajectories from a saddle leave, or where one touches the
  // boundary from within, the image goes as a power less than 1 of the distance.
  constexpr double kNear = 0.1;
  const auto complete = [&](double& image, double at, double onwards) {
    const bool jumps = std::count_if(rest.parts.begin(), rest.parts.end(), [&](const ContinuousArc& p) {
                         const double away = std::remainder(p.entry.begin - at, 3.0);
                         return std::abs(away) < 1e-12 || std::abs(std::remainder(away + p.entry.length, 3.0)) < 1e-12;
                       }) > 1;
    if (!jumps || image == FaceTransit::kRest) return;
    const BoundaryArc arc = transit.arcOf(f, image);
    std::vector<double> limits;
    for (const double end : {arc.begin, std::fmod(arc.begin + arc.length, 3.0)}) {
      if (transit.touchesAt(f, end)) limits.push_back(end);
    }
    for (const BoundaryArc& out : rest.out) {
      if (isSaddle && transit.sameArc(f, out.begin, image)) limits.push_back(out.begin);
    }
    double nearest = kNear, found = image;
    for (const double limit : limits) {
      const double away = onwards * std::remainder(limit - image, 3.0);
      if (away < 0.0 || away >= nearest) continue;
      nearest = away;
      found = limit;
    }
    image = found;
  };
  for (ContinuousArc& part : rest.parts) {
    complete(part.imageOfBegin, part.entry.begin, 1.0);  // images go back
    complete(part.imageOfEnd, part.entry.begin + part.entry.length, -1.0);
  }
  return rest;
}

double TransitMap::positionIn(Index f, Index edge, double fraction) const {
  const Index h = mesh().edgeHalfedge(edge);
  if (TriangleMesh::face(h) == f) return TriangleMesh::corner(h) + fraction;
  return TriangleMesh::corner(mesh().twin(h)) + 1.0 - fraction;
}

/// A part of an edge, cut at jumps in faces with a fixed point. Elsewhere pieces may hold jumps.
void TransitMap::cut(const EdgePiece& piece, Cuts& cuts) const {
  if (piece.enters < 0 || transit_->isCoarse(piece.enters)) {
    cuts.push_back({piece.to, FaceTransit::kRest, FaceTransit::kRest});
    return;
  }
  const Index f = piece.enters;
  const auto at = [&](double fraction) { return positionIn(f, piece.edge, fraction); };
  if (restSlot_[f] != kNone) return cutAtJumps(piece, rests_[restSlot_[f]], cuts);
  const double from = at(piece.from), to = at(piece.to);
  cuts.push_back({piece.to, transit_->leavesFromEnd(f, from, to), transit_->leavesFromEnd(f, to, from)});
}

void TransitMap::cutAtJumps(const EdgePiece& piece, const Rest& rest, Cuts& cuts) const {
  const Index f = piece.enters;
  const double a = positionIn(f, piece.edge, piece.from), b = positionIn(f, piece.edge, piece.to);
  const double begin = std::min(a, b), end = std::max(a, b);
  std::vector<ContinuousArc> found;
  for (const ContinuousArc& part : rest.parts) {
    for (const int turn : {-3, 0, 3}) {
      const double from = std::max(begin, part.entry.begin + turn);
      const double to = std::min(end, part.entry.begin + turn + part.entry.length);
      if (to - from < 1e-12) continue;
      const bool whole[] = {from > begin, to < end};
      found.push_back({{from, to - from},
                       whole[0] ? part.imageOfBegin : transit_->leavesFromEnd(f, from, to),
                       whole[1] ? part.imageOfEnd : transit_->leavesFromEnd(f, to, from)});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const ContinuousArc& p, const ContinuousArc& q) { return p.entry.begin < q.entry.begin; });
  if (found.empty()) found.push_back({{begin, end - begin}, FaceTransit::kRest, FaceTransit::kRest});
  if (a > b) std::reverse(found.begin(), found.end());
  for (const auto& [entry, imageOfBegin, imageOfEnd] : found) {
    const double last = std::abs((a < b ? entry.begin + entry.length : entry.begin) - a) + piece.from;
    cuts.push_back({last, a < b ? imageOfBegin : imageOfEnd, a < b ? imageOfEnd : imageOfBegin});
  }
  cuts.back().to = piece.to;
}

std::vector<std::size_t> TransitMap::halve(const std::vector<Index>& nodes, Progress* progress) {
  const std::size_t count = nodes.size();
  std::vector<double> images(count, FaceTransit::kRest);
  eachOf(cones_ ? 0 : count, progress, [&](std::size_t i) {
    const EdgePiece& piece = this->piece(nodes[i]);
    if (piece.enters < 0 || transit_->isCoarse(piece.enters)) return;
    images[i] = transit_->leaves(piece.enters, positionIn(piece.enters, piece.edge, 0.5 * (piece.from + piece.to)));
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
    first.imageTo = second.imageFrom = images[i];
    if (cones_) {
      first.enters = enteredBy(first.edge, cones_->crossing(first.edge, first.from, first.to));
      second.enters = enteredBy(second.edge, cones_->crossing(second.edge, second.from, second.to));
    }
    secondOf[at] = pieceCount();
    firsts.push_back(i);
    pieces_.push_back(second);
  }
  const std::vector<Place> before = std::move(places_);
  places_.clear();
  places_.reserve(pieces_.size());
  std::size_t begin = 0;
  for (std::size_t e = 1; e < offsets_.size(); ++e) {
    for (; begin < offsets_[e]; ++begin) {
      const Index first = before[begin].piece, second = secondOf[first];
      places_.push_back(second == kNone ? before[begin] : placeOf(first));
      if (second != kNone) places_.push_back(placeOf(second));
    }
    offsets_[e] = places_.size();
  }
  return firsts;
}

/// visit(node, piece) for the pieces within the slack of an arc over which flow leaves a face.
template <typename Visit>
void TransitMap::eachExit(Index f, const BoundaryArc& arc, const Visit& visit) const {
  // The extremes of all fields are turned to spare (cone_transit.h).
  constexpr double kSlack = FaceTransit::kSlack;
  const BoundaryArc reach = cones_ || arc.length >= kAround.length
                                ? BoundaryArc{arc.begin - kSlack, arc.length + 2.0 * kSlack}
                                : transit_->widened(f, arc);
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    const Index e = mesh().edge(h);
    const bool canonical = mesh().edgeHalfedge(e) == h;
    for (const int turn : {-3, 0, 3}) {
      const double side = TriangleMesh::corner(h) + turn;
      double from = reach.begin - side;
      double to = reach.begin + reach.length - side;
      if (from > 1.0 || to < 0.0) continue;
      if (!canonical) {
        std::swap(from, to);
        from = 1.0 - from;
        to = 1.0 - to;
      }
      const Place* const first = places_.data() + offsets_[e];
      const Place* const end = places_.data() + offsets_[e + 1];
      const Place* at =
          std::lower_bound(first, end, from, [](const Place& p, double fraction) { return p.to < fraction; });
      for (; at != end && (at == first || at[-1].to <= to); ++at) {
        const bool crossed = at->enters != f && at->enters != EdgePiece::kAlong;
        if (crossed) visit(nodeOf(at->piece), pieces_[at->piece]);
      }
    }
  }
}

/// The pieces over the arc of the boundary that what enters through a piece can leave through.
void TransitMap::addExits(Index f, const EdgePiece& piece, std::vector<Index>& targets) const {
  const auto turned = [](double from, double to) {
    const double way = to - from;
    return way < 0.0 ? way + 3.0 : way;
  };
  double begin = positionIn(f, piece.edge, piece.from), end = positionIn(f, piece.edge, piece.to);
  double imageOfBegin = piece.imageFrom, imageOfEnd = piece.imageTo;
  if (begin > end) {
    std::swap(begin, end);
    std::swap(imageOfBegin, imageOfEnd);
  }
  std::array<BoundaryArc, 2> images;
  if (const auto [exits, both] = transit_->arcOfBoth(f, imageOfBegin, imageOfEnd); both) {
    // By place within the arc, as round-off may change the order of two images.
    const auto within = [&](double position) {
      const double away = turned(exits.begin, position);
      return away > 0.5 * (3.0 + exits.length) ? away - 3.0 : away;
    };
    const double a = within(imageOfBegin), b = within(imageOfEnd);
    images.fill({exits.begin + std::min(a, b), std::abs(a - b)});
  } else {
    // Trajectories do not cross, so that images go back as the piece goes on.
    const double first = imageOfEnd == FaceTransit::kRest ? end : imageOfEnd;
    const double last = imageOfBegin == FaceTransit::kRest ? begin : imageOfBegin;
    const auto [before, after] = jumpBetween(f, first, last);
    images = {BoundaryArc{first, turned(first, before)}, BoundaryArc{after, turned(after, last)}};
  }
  for (const BoundaryArc& image : images) {
    eachExit(f, image, [&](Index node, const EdgePiece&) { targets.push_back(node); });
  }
}

/// What a trajectory that touches the boundary from within at a position goes on to; kRest where none touches there.
double TransitMap::touched(Index f, double position) const {
  if (!transit_->touchesAt(f, position)) return FaceTransit::kRest;
  return touches_[mesh().edge(TriangleMesh::halfedge(f, static_cast<int>(std::fmod(position, 3.0))))];
}

/// Where images go over from one arc of exit to the next, between a position in each: at the end of one of the arcs
/// trajectories touch the boundary. Unknown jumps are between the two positions themselves, any way.
std::pair<double, double> TransitMap::jumpBetween(Index f, double first, double last) const {
  const BoundaryArc from = transit_->arcOf(f, first), to = transit_->arcOf(f, last);
  const double onwards = touched(f, from.begin + from.length), back = touched(f, to.begin);
  if (onwards != FaceTransit::kRest && transit_->sameArc(f, onwards, last)) {
    return {from.begin + from.length, onwards};
  }
  if (back != FaceTransit::kRest && transit_->sameArc(f, back, first)) return {back, to.begin};
  return {last, last};
}

bool TransitMap::meets(const std::vector<BoundaryArc>& arcs, Index f, const EdgePiece& piece) const {
  const double c = positionIn(f, piece.edge, piece.from), d = positionIn(f, piece.edge, piece.to);
  return std::any_of(arcs.begin(), arcs.end(),
                     [&](const BoundaryArc& arc) { return meet(std::min(c, d), std::abs(d - c), arc); });
}

/// Where the flow along halfedge h of a face begins (end: 0) or ends (1).
double TransitMap::endAlong(Index f, Index h, double end) const {
  const Index e = mesh().edge(h);
  return positionIn(f, e, transit_->edgeFlow(e).along > 0 ? end : 1.0 - end);
}

/// The edges that flow runs along from where a piece enters a face.
void TransitMap::addEdgesAlong(Index f, const EdgePiece& piece, std::vector<Index>& targets) const {
  for (Index h = 3 * f; h < 3 * f + 3; ++h) {
    const Index e = mesh().edge(h);
    if (transit_->edgeFlow(e).along == 0 || !meets({{endAlong(f, h, 0.0), 0.0}}, f, piece)) continue;
    targets.push_back(nodeOf(places_[offsets_[e]].piece));
  }
}

void TransitMap::enter(Index f, const EdgePiece& piece, std::vector<Index>& targets) const {
  addEdgesAlong(f, piece, targets);
  const bool rests = piece.imageFrom == FaceTransit::kRest || piece.imageTo == FaceTransit::kRest;
  const bool stays = piece.imageFrom == piece.imageTo && rests;
  const Index slot = restSlot_[f];
  const bool lost = rests && transit_->poincare()[f] < 0;  // nothing but single trajectories stays at a saddle
  if (lost || (slot == kNone && rests)) {
    if (transit_->holdsFixedPoint(f)) targets.push_back(f);
    eachExit(f, kAround, [&](Index node, const EdgePiece&) { targets.push_back(node); });
    return;
  }
  if (slot != kNone && (rests || meets(rests_[slot].in, f, piece))) targets.push_back(f);
  if (!stays) addExits(f, piece, targets);
}

/// What enters a face through a piece of its boundary may come to, in some field within the bound. Where none rests, a
/// piece leads to itself only by way of others.
void TransitMap::enterForAll(Index f, Index node, std::vector<Index>& targets) const {
  if (cones_->mayHoldFixedPoint(f)) {
    targets.push_back(f);  // and from there on to all exits
    return;
  }
  const EdgePiece& piece = this->piece(node);
  const double a = positionIn(f, piece.edge, piece.from), b = positionIn(f, piece.edge, piece.to);
  const double begin = std::min(a, b), end = std::max(a, b);
  const int side = std::min(2, static_cast<int>(0.5 * (begin + end)));
  for (const BoundaryArc& arc : cones_->leaving(f, side, begin - side, end - side)) {
    eachExit(f, arc, [&](Index exit, const EdgePiece& over) {
      if (exit != node) targets.push_back(reached(exit, over));
    });
  }
}

/// What leaves over the surface's boundary does not come back over it, also where other flow enters.
Index TransitMap::reached(Index node, const EdgePiece& piece) const {
  return mesh().twin(mesh().edgeHalfedge(piece.edge)) == kNone ? outside() : node;
}

void TransitMap::rowForAll(Index node, std::vector<Index>& targets) const {
  if (node < mesh().faceCount()) {
    if (!cones_->mayHoldFixedPoint(node)) return;
    targets.push_back(node);
    eachExit(node, kAround, [&](Index exit, const EdgePiece& over) { targets.push_back(reached(exit, over)); });
  } else if (node < outside()) {
    const EdgePiece& piece = this->piece(node);
    const Index h = mesh().edgeHalfedge(piece.edge), twin = mesh().twin(h);
    if (piece.enters == EdgePiece::kOutside) {
      targets.push_back(outside());
    } else if (piece.enters != EdgePiece::kBothFaces) {
      enterForAll(piece.enters, node, targets);
    } else {
      enterForAll(TriangleMesh::face(h), node, targets);
      if (twin != kNone) enterForAll(TriangleMesh::face(twin), node, targets);
    }
  }
}

bool TransitMap::isSettled(Index node) const {
  if (!isPiece(node)) return true;
  if (!cones_) return piece(node).enters < 0 || transit_->isCoarse(piece(node).enters);
  const Index h = mesh().edgeHalfedge(piece(node).edge), twin = mesh().twin(h);
  return cones_->mayHoldFixedPoint(TriangleMesh::face(h)) &&
         (twin == kNone || cones_->mayHoldFixedPoint(TriangleMesh::face(twin)));
}

void TransitMap::row(Index node, std::vector<Index>& targets) const {
  targets.clear();
  if (cones_) {
    rowForAll(node, targets);
  } else if (node < mesh().faceCount()) {
    if (!transit_->holdsFixedPoint(node)) return;
    targets.push_back(node);
    const Index slot = restSlot_[node];
    eachExit(node, kAround, [&](Index exit, const EdgePiece& piece) {
      if (slot == kNone || meets(rests_[slot].out, node, piece)) targets.push_back(exit);
    });
  } else if (node < outside()) {
    const EdgePiece& piece = this->piece(node);
    const Index h = mesh().edgeHalfedge(piece.edge);
    if (piece.enters == EdgePiece::kOutside) {
      targets.push_back(outside());
    } else if (piece.enters >= 0) {
      enter(piece.enters, piece, targets);
    } else if (piece.enters == EdgePiece::kBothFaces) {
      for (const Index side : {h, mesh().twin(h)}) {
        if (side == kNone) {
          targets.push_back(outside());
        } else {
          enter(TriangleMesh::face(side), piece, targets);
        }
      }
    } else {
      for (const Index side : {h, mesh().twin(h)}) {
        if (side == kNone) continue;
        const Index f = TriangleMesh::face(side);
        eachExit(f, {endAlong(f, side, 1.0), 0.0}, [&](Index exit, const EdgePiece&) { targets.push_back(exit); });
      }
    }
  }
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
}

CombinatorialMap TransitMap::map(Progress* progress) const {
  std::vector<Index> nodes, place(static_cast<std::size_t>(outside()) + 1);
  nodes.reserve(place.size());
  eachNode([&](Index node) { nodes.push_back(node); });
  nodes.push_back(outside());
  std::iota(place.begin(), place.end(), 0);
  return {graphByPlace(nodes, place, progress)};
}

DirectedGraph TransitMap::graphAmong(const std::vector<Index>& nodes, Progress* progress) const {
  std::vector<Index> place(static_cast<std::size_t>(outside()) + 1, kNone);
  for (std::size_t i = 0; i < nodes.size(); ++i) place[nodes[i]] = static_cast<Index>(i);
  return graphByPlace(nodes, place, progress);
}

/// place: of each node of the map in the graph, kNone for those that are not among the nodes.
DirectedGraph TransitMap::graphByPlace(const std::vector<Index>& nodes, const std::vector<Index>& place,
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
        if (place[target] != kNone) targets.push_back(place[target]);
      }
      std::sort(targets.begin() + static_cast<std::ptrdiff_t>(before), targets.end());
      graph.offsets[static_cast<std::size_t>(place[nodes[i]]) + 1] = targets.size() - before;
    }
  });
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
  graph.targets.resize(graph.offsets.back());
  eachBlock([&](std::vector<Index>& targets, std::size_t begin, std::size_t end) {
    auto from = targets.begin();
    for (std::size_t i = begin; i < end; ++i) {
      const Index at = place[nodes[i]];
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
    if (piece.enters >= 0) faces.push_back(piece.enters);
    if (piece.enters != EdgePiece::kBothFaces && piece.enters != EdgePiece::kAlong) return;
    const Index h = mesh().edgeHalfedge(piece.edge), twin = mesh().twin(h);
    faces.push_back(TriangleMesh::face(h));
    if (twin != kNone) faces.push_back(TriangleMesh::face(twin));
  }
}

}  // namespace stormfield
