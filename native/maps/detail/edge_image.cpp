#include "maps/detail/edge_image.h"

#include "tracing/dense_step.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stormfield {
namespace {

/// Halvings of an edge at most, and where both ends leave the surface: 2^-28 of an edge is what traces resolve.
constexpr int kDeepest = 28, kDeepestOutside = 6;
/// How far an image may leave its chords, in face sizes, and how long these may be.
constexpr double kFlat = 0.25, kFlatOnTheWay = 0.4, kLongest = 1.5;
/// Of what an interval may leave its chords by, this part is left for its halves; where nothing can be seen, of chords.
constexpr double kLeft = 0.3, kUnseen = 0.1;
/// By how much a step bends chords, as a part of the gradient's turn; less in one face, where the field is all but
/// linear. And the most by which one step is taken to draw them out (its logarithm).
constexpr double kFed = 0.025, kFedInFace = 0.1, kMostGrowth = 3.0;
/// Chords shorter than this part of a face show what lies between their ends, but for this part of their length. In
/// Morse sets, where images are followed for long, all of them are taken to.
constexpr double kShort = 0.25, kShown = 0.25;
/// Padding around chords: this part of how far images may leave them, and of chord and face size at least.
constexpr double kPadding = 1.0, kChordPadding = 0.01, kLeastPadding = 2e-3;
/// Of the largest radius of some samples: inside the faces, it may be larger.
constexpr double kReach = 1.25;

}  // namespace

EdgeImageSampler::EdgeImageSampler(const PreparedFlow& flow, double tau, int steps, const SetWindows* windows,
                                   const Progress* progress, std::size_t maxSamples)
    : flow_(&flow),
      tau_(tau),
      windows_(windows),
      steps_(steps),
      maxSamples_(maxSamples),
      forward_(flow.advector(Direction::Forward, progress)),
      backward_(flow.advector(Direction::Backward, progress)),
      near_(flow.faces()) {}

void EdgeImageSampler::make(std::span<const EdgeToSample> edges, const Keep& keep) {
  edges_ = edges;
  keep_ = &keep;
  started_ = 0;
  alone_ = false;
  forward_->advectAll(*this);
  // Which of too many samples an image goes without depends on their order: these edges do not share the lanes.
  alone_ = true;
  std::sort(crowded_.begin(), crowded_.end());
  for (const std::size_t number : crowded_) {
    start(number);
    forward_->advectAll(*this);
  }
  crowded_.clear();
}

/// The moves that are asked for, and when there are none, those of another edge.
bool EdgeImageSampler::next(int lane, AdvectedPoint& from, double& tau) {
  while (moves_.empty() && started_ < edges_.size()) start(started_++);
  if (moves_.empty()) return false;
  const Move& move = moving_[lane] = moves_.back();
  moves_.pop_back();
  const Edge& edge = slots_[move.edge];
  const Sample& sample = edge.samples[move.sample];
  from = sample.place == kNowhere ? AdvectedPoint{.point = pointAt(edge, sample.s)} : edge.places[sample.place].at;
  tau = tau_ * move.steps / steps_;
  return true;
}

void EdgeImageSampler::arrive(int lane, const AdvectedPoint& at) {
  const auto [slot, sample, steps] = moving_[lane];
  addPlace(slots_[slot], sample, at, steps);
  slots_[slot].samples[sample].underWay = false;
  for (const int interval : std::exchange(slots_[slot].samples[sample].waiting, {kNowhere, kNowhere})) {
    if (interval != kNowhere) proceed(slot, interval);
  }
  if (slots_[slot].open == 0) finish(slot);
}

void EdgeImageSampler::start(std::size_t number) {
  if (free_.empty()) {
    free_.push_back(slots_.size());
    slots_.emplace_back();
  }
  const std::size_t slot = free_.back();
  free_.pop_back();
  Edge& edge = slots_[slot];
  edge.number = number;
  edge.halfedge = flow_->mesh().edgeHalfedge(edges_[number].edge);
  edge.image.faces.clear();
  edge.image.leaves = edge.crowded = false;
  edge.samples.clear();
  edge.places.clear();
  edge.intervals.clear();
  const int tail = addKnown(edge, 0.0, edges_[number].tail), head = addKnown(edge, 1.0, edges_[number].head);
  open(slot, {0, tail}, {1, head}, 1, 0, 0.0);
}

void EdgeImageSampler::finish(std::size_t slot) {
  Edge& edge = slots_[slot];
  free_.push_back(slot);
  if (edge.crowded) {
    crowded_.push_back(edge.number);
    return;
  }
  std::vector<Index>& faces = edge.image.faces;
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  (*keep_)(edge.number, edge.image);
}

/// A sample that needs no tracing for the first steps; its place after the first one.
int EdgeImageSampler::addKnown(Edge& edge, double s, std::span<const AdvectedPoint> arrivals) {
  const int sample = static_cast<int>(edge.samples.size()), first = static_cast<int>(edge.places.size());
  edge.samples.push_back({s});
  for (const AdvectedPoint& at : arrivals) addPlace(edge, sample, at, 1);
  edge.image.leaves |= arrivals.front().left;
  return first;
}

void EdgeImageSampler::addPlace(Edge& edge, int sample, const AdvectedPoint& at, int steps) {
  const int place = static_cast<int>(edge.places.size());
  Sample& of = edge.samples[sample];
  if (of.place != kNowhere) edge.places[of.place].next = place;
  of.place = place;
  of.step += steps;
  edge.places.push_back({at});
}

/// The interval between two samples, from a step on.
void EdgeImageSampler::open(std::size_t slot, Stop a, Stop b, int step, int level, double away) {
  Edge& edge = slots_[slot];
  const int middle = static_cast<int>(edge.samples.size()), interval = static_cast<int>(edge.intervals.size());
  edge.samples.push_back({0.5 * (edge.samples[a.sample].s + edge.samples[b.sample].s)});
  const double half = 0.5 * flow_->mesh().edgeLength(edges_[edge.number].edge);
  edge.intervals.push_back({{a, {middle, kNowhere}, b}, {false, true, false}, step, level, away, {half, half}});
  ++edge.open;
  ++traces_;
  gather(slot, interval);
}

/// Follows the image of an interval until it is enclosed at the end or out of sight, is halved, or has to wait.
void EdgeImageSampler::proceed(std::size_t slot, int number) {
  Edge& edge = slots_[slot];
  while (edge.crowded ? !waits(edge, number) : gather(slot, number)) {
    Interval& interval = edge.intervals[number];
    const Verdict verdict = edge.crowded ? Verdict::Done : judge(edge, interval);
    if (verdict == Verdict::Goes) {
      ++interval.step;
      interval.behind.fill(true);
      continue;
    }
    if (verdict == Verdict::Halve) halve(slot, Interval(interval));
    --edge.open;
    return;
  }
}

bool EdgeImageSampler::waits(const Edge& edge, int number) const {
  return std::any_of(edge.intervals[number].stops.begin(), edge.intervals[number].stops.end(), [&](const Stop& stop) {
    const auto& [one, other] = edge.samples[stop.sample].waiting;
    return one == number || other == number;
  });
}

/// Brings the stops to the interval's step; false where it has to wait for one.
bool EdgeImageSampler::gather(std::size_t slot, int number) {
  Edge& edge = slots_[slot];
  Interval& interval = edge.intervals[number];
  bool all = true;
  for (int i = 0; i < 3; ++i) {
    if (!interval.behind[i]) continue;
    auto& [index, place] = interval.stops[i];
    Sample& sample = edge.samples[index];
    if (place != kNowhere && edge.places[place].next == kNowhere && edge.places[place].at.left) {
      addPlace(edge, index, AdvectedPoint(edge.places[place].at), 1);
    }
    const int next = place == kNowhere ? sample.place : edge.places[place].next;
    if (next != kNowhere) {
      place = next;
      interval.behind[i] = false;
      edge.image.leaves |= edge.places[next].at.left;
      continue;
    }
    all = false;
    if (!sample.underWay) moves_.push_back({slot, index, interval.step - sample.step});
    sample.underWay = true;
    auto& [one, other] = sample.waiting;
    if (one != number && other != number) (one == kNowhere ? one : other) = number;
  }
  return all;
}

void EdgeImageSampler::halve(std::size_t slot, const Interval& interval) {
  Edge& edge = slots_[slot];
  const auto& [a, middle, b] = interval.stops;
  const bool full = edge.samples.size() >= maxSamples_;
  if (full && !alone_) {
    edge.crowded = true;
  } else if (full || interval.level == kDeepest) {
    bridge(edge, a, middle, interval.step);
    bridge(edge, middle, b, interval.step);
  } else {
    open(slot, a, middle, interval.step, interval.level + 1, kLeft * interval.away);
    open(slot, middle, b, interval.step, interval.level + 1, kLeft * interval.away);
  }
}

SurfacePoint EdgeImageSampler::pointAt(const Edge& edge, double s) const {
  SurfacePoint p{TriangleMesh::face(edge.halfedge)};
  const int i = TriangleMesh::corner(edge.halfedge);
  p.barycentric[i] = 1.0 - s;
  p.barycentric[(i + 1) % 3] = s;
  return p;
}

/// Whether the image of an interval is enclosed at its step.
EdgeImageSampler::Verdict EdgeImageSampler::judge(Edge& edge, Interval& interval) {
  const auto at = [&](int i) -> const AdvectedPoint& { return edge.places[interval.stops[i].place].at; };
  const AdvectedPoint &a = at(0), &middle = at(1), &b = at(2);
  double& away = interval.away;
  if (a.left && middle.left && b.left && interval.level >= kDeepestOutside) return Verdict::Done;
  const Shape shape = shapeOf(a, middle, b);
  if (!shape.comparable()) {
    away = -1.0;
    return Verdict::Halve;
  }
  if (away < 0.0) away = kUnseen * shape.longest;
  if (!interval.first || interval.level == 0) away = grown(interval, a, middle, b, shape);
  interval.first = false;
  interval.chords = shape.chords;
  away = std::max(away, shape.apart + shape.spread);
  const bool last = interval.step == steps_;
  const double flat = last ? kFlat : kFlatOnTheWay;
  if (away > flat * shape.size || shape.longest > kLongest * shape.size) return Verdict::Halve;
  if (!last && windows_ == nullptr) return Verdict::Goes;
  const double radius = kReach * std::max({a.radius, middle.radius, b.radius});
  collect(a, middle, b, shape, kPadding * away + kChordPadding * shape.longest + kLeastPadding * shape.size + radius);
  if (!staysInSight(interval.step)) return Verdict::Done;
  if (!last) return Verdict::Goes;
  keep(edge);
  return Verdict::Done;
}

/// How far an image that was so far from its chords may be after the next step. The flow draws it apart by no more than
/// it draws any vector out. And as it keeps the area between a chord and what is off it but for the divergence, it does
/// so by no more than that over how much longer the chord has become; this is known where chords are short enough to
/// show it. Chords bend where they are in more than one face.
double EdgeImageSampler::grown(const Interval& interval, const AdvectedPoint& a, const AdvectedPoint& middle,
                               const AdvectedPoint& b, const Shape& shape) const {
  const Index f = middle.point.face, left = a.point.face, right = b.point.face;
  const double step = tau_ / steps_;
  const double growth = std::max({flow_->growth(f), flow_->growth(left), flow_->growth(right)});
  const double spreading = std::max({flow_->divergence(f), flow_->divergence(left), flow_->divergence(right)});
  const double bending = std::max({flow_->bending(f), flow_->bending(left), flow_->bending(right)});
  const double shorter = std::max(interval.chords[0] / shape.chords[0], interval.chords[1] / shape.chords[1]);
  const bool inOneFace = f == left && f == right;
  const double fed = kFed * (inOneFace ? kFedInFace : 1.0) * std::min(bending * step, 1.0) * shape.longest;
  const double drawn = std::exp(std::min(growth * step, kMostGrowth)) * interval.away + fed;
  if (windows_ != nullptr) return std::min(drawn, kShown * shape.longest);
  if (std::max(interval.chords[0], interval.chords[1]) > kShort * shape.size) return drawn;
  const double spread = std::exp(std::min(spreading * step, kMostGrowth)) * shorter * interval.away + fed;
  return std::min(drawn, std::max(spread, kShown * shape.longest));
}

EdgeImageSampler::Shape EdgeImageSampler::shapeOf(const AdvectedPoint& a, const AdvectedPoint& middle,
                                                  const AdvectedPoint& b) const {
  const FlatFaces& faces = flow_->faces();
  const SurfacePoint &pointA = a.point, &point = middle.point, &pointB = b.point;
  Shape shape{{faces, point.face, pointA.face}, {faces, point.face, pointB.face}};
  if (!shape.comparable()) return shape;
  shape.at = faces[point.face].point(point.barycentric);
  shape.inA = faces[pointA.face].point(pointA.barycentric);
  shape.inB = faces[pointB.face].point(pointB.barycentric);
  shape.apart = std::numeric_limits<double>::infinity();
  for (int i = 0; i < shape.toA.count(); ++i) {
    for (int j = 0; j < shape.toB.count(); ++j) {
      shape.apart =
          std::min(shape.apart, magnitude(shape.at - 0.5 * (shape.toA[i](shape.inA) + shape.toB[j](shape.inB))));
    }
  }
  shape.chords = {magnitude(shape.at - shape.toA[0](shape.inA)), magnitude(shape.at - shape.toB[0](shape.inB))};
  shape.longest = std::max(shape.chords[0], shape.chords[1]);
  shape.spread = std::max(shape.toA.spread(shape.at, shape.inA), shape.toB.spread(shape.at, shape.inB));
  shape.size = faceSize(faces[point.face]);
  return shape;
}

/// Collects the faces near the chords from the middle to the two ends. What has left the surface counts where it left.
void EdgeImageSampler::collect(const AdvectedPoint& a, const AdvectedPoint& middle, const AdvectedPoint& b,
                               const Shape& shape, double padding) {
  met_.clear();
  meetsExit_ = false;
  const auto onBoundary = [&](Index h) { meetsExit_ |= flow_->flowsOut(h); };
  const auto chords = [&](const AdvectedPoint& end, const Unfoldings& ways, Complex inEnd) {
    if (end.left && middle.left) return;
    met_.push_back(end.point.face);
    for (int i = 0; i < ways.count(); ++i) {
      near_.collect(middle.point.face, shape.at, ways[i](inEnd), padding, met_, onBoundary);
    }
  };
  chords(a, shape.toA, shape.inA);
  chords(b, shape.toB, shape.inB);
}

void EdgeImageSampler::keep(Edge& edge) {
  edge.image.leaves |= meetsExit_;
  edge.image.faces.insert(edge.image.faces.end(), met_.begin(), met_.end());
}

bool EdgeImageSampler::staysInSight(int step) const {
  if (windows_ == nullptr) return true;
  return std::any_of(met_.begin(), met_.end(), [&](Index f) { return windows_->holds(step, f); });
}

/// Between two samples as close as can be, whose images are apart.
void EdgeImageSampler::bridge(Edge& edge, const Stop& from, const Stop& to, int step) {
  const auto atTheEnd = [&](const Stop& stop) {
    AdvectedPoint at = edge.places[stop.place].at;
    if (!at.left && step < steps_) at = forward_->advect(at, tau_ * (steps_ - step) / steps_);
    edge.image.leaves |= at.left;
    return at;
  };
  const AdvectedPoint a = atTheEnd(from), b = atTheEnd(to);
  if (a.left && b.left) return;
  const Shape shape = shapeOf(a, a, b);
  if (shape.comparable() && shape.longest <= kFlat * shape.size) {
    collect(a, a, b, shape, shape.longest + kReach * std::max(a.radius, b.radius));
    keep(edge);
  } else if (a.left || b.left) {
    addTorn(edge, edge.samples[a.left ? to.sample : from.sample].s);
  } else {
    addParting(edge, edge.samples[from.sample].s, edge.samples[to.sample].s, kReach * std::max(a.radius, b.radius));
  }
}

/// One sample left, its neighbour only touches the boundary: between them runs the neighbour's own trajectory, as far
/// as it goes through the two faces of the edge before and after the sample.
void EdgeImageSampler::addTorn(Edge& edge, double staying) {
  const TriangleMesh& mesh = flow_->mesh();
  const Index h = edge.halfedge, twin = mesh.twin(h);
  const auto beside = [&](const TrajectoryPoint& p) {
    return p.point.face == TriangleMesh::face(h) || (twin != kNone && p.point.face == TriangleMesh::face(twin));
  };
  const SurfacePoint from = pointAt(edge, staying);
  const auto stay = [&](PointAdvector& advector) {
    double longest = 0.0;
    for (const TrajectoryPoint& p : advector.trajectory(from, tau_)) {
      longest = p.tau;
      if (!beside(p)) break;
    }
    return longest;
  };
  const double before = stay(*backward_), after = stay(*forward_);
  for (const TrajectoryPoint& p : forward_->trajectory(from, tau_ + after)) {
    if (p.tau >= tau_ - before) edge.image.faces.push_back(p.point.face);
  }
}

/// Both stay, on trajectories that part on the way: between their ends lies what they met after that.
void EdgeImageSampler::addParting(Edge& edge, double a, double b, double radius) {
  const auto wayA = forward_->trajectory(pointAt(edge, a), tau_), wayB = forward_->trajectory(pointAt(edge, b), tau_);
  std::size_t common = 0;
  while (common < std::min(wayA.size(), wayB.size()) && wayA[common].point.face == wayB[common].point.face) ++common;
  for (const auto* way : {&wayA, &wayB}) {
    for (std::size_t i = common == 0 ? 0 : common - 1; i < way->size(); ++i) {
      const auto& [face, at] = (*way)[i].point;
      const Complex p = flow_->faces()[face].point(at);
      near_.collect(face, p, p, radius, edge.image.faces, [](Index) {});
    }
  }
}

}  // namespace stormfield
