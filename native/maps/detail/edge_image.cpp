#include "maps/detail/edge_image.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stormfield {
namespace {

/// Halvings of an edge at most: 2^-28 of an edge is what traces resolve. Where both ends and the middle have left the
/// surface, 2^-6: what may pass between them is found at the tangency (boundary_tangencies.h).
constexpr int kMaxLevel = 28, kMaxLevelOutside = 6;

// The factors below are as large (limits) or as small (padding) as the tests of tau maps allow: they look for points
// that leave their image.

/// Largest deviation of an image from its chords, in face sizes: after the last step, and after those before it, whose
/// faces do not enter F.
constexpr double kMaxDeviation = 0.25, kMaxDeviationBefore = 0.4;
/// Longest chord, in face sizes: longer ones leave the ring of neighbours that can be unfolded.
constexpr double kMaxChord = 1.5;
/// Fraction of an interval's deviation that its halves start with. Halving a smooth curve leaves 1/4; the rest is
/// margin.
constexpr double kInheritedDeviation = 0.3;
/// Deviation where images became comparable only after halving, in chord lengths: that of an arc of 45 degrees.
constexpr double kDefaultDeviation = 0.1;
/// Padding around chords: this fraction of the deviation, plus these of the longest chord and of the face size.
constexpr double kDeviationPadding = 1.0, kChordPadding = 0.01, kFacePadding = 2e-3;
/// Factor on the largest radius of the samples (divergence_bound.h): between samples the radius may be larger.
constexpr double kRadiusFactor = 1.25;

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

void EdgeImageSampler::sample(std::span<const EdgeToSample> edges, const OnImage& onImage) {
  edges_ = edges;
  onImage_ = &onImage;
  started_ = 0;
  isAlone_ = false;
  forward_->advectAll(*this);
  // Which samples an image with too many of them goes without depends on the order in which they arrive: these edges
  // are sampled again, one at a time.
  isAlone_ = true;
  std::sort(crowded_.begin(), crowded_.end());
  for (const std::size_t number : crowded_) {
    startEdge(number);
    forward_->advectAll(*this);
  }
  crowded_.clear();
}

// The queue of advections --------------------------------------------------------------------------------------------

bool EdgeImageSampler::next(int lane, AdvectedPoint& from, double& tau) {
  while (queue_.empty() && started_ < edges_.size()) startEdge(started_++);
  if (queue_.empty()) return false;
  const Advection& advection = inLane_[lane] = queue_.back();
  queue_.pop_back();
  const Edge& edge = slots_[advection.slot];
  const Sample& sample = edge.samples[advection.sample];
  from = sample.image == kNone ? AdvectedPoint{.point = pointAt(edge, sample.fraction)} : edge.images[sample.image].at;
  tau = tau_ * advection.steps / steps_;
  return true;
}

void EdgeImageSampler::arrive(int lane, const AdvectedPoint& image) {
  const auto [slot, sample, steps] = inLane_[lane];
  addImage(slots_[slot], sample, image, steps);
  slots_[slot].samples[sample].isQueued = false;
  for (const int interval : std::exchange(slots_[slot].samples[sample].waiting, {kNone, kNone})) {
    if (interval != kNone) advanceInterval(slot, interval);
  }
  if (slots_[slot].openIntervals == 0) finishEdge(slot);
}

// Edges and their samples --------------------------------------------------------------------------------------------

void EdgeImageSampler::startEdge(std::size_t number) {
  if (freeSlots_.empty()) {
    freeSlots_.push_back(slots_.size());
    slots_.emplace_back();
  }
  const std::size_t slot = freeSlots_.back();
  freeSlots_.pop_back();
  Edge& edge = slots_[slot];
  edge.number = number;
  edge.halfedge = flow_->mesh().edgeHalfedge(edges_[number].edge);
  edge.image.faces.clear();
  edge.image.leavesSurface = edge.isCrowded = false;
  edge.samples.clear();
  edge.images.clear();
  edge.intervals.clear();
  const int tail = addKnownSample(edge, 0.0, edges_[number].tail);
  const int head = addKnownSample(edge, 1.0, edges_[number].head);
  addInterval(slot, {0, tail}, {1, head}, 1, 0, 0.0);
}

void EdgeImageSampler::finishEdge(std::size_t slot) {
  Edge& edge = slots_[slot];
  freeSlots_.push_back(slot);
  if (edge.isCrowded) {
    crowded_.push_back(edge.number);
    return;
  }
  std::vector<Index>& faces = edge.image.faces;
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  (*onImage_)(edge.number, edge.image);
}

/// Adds a sample whose first images are known; returns the number of its first image.
int EdgeImageSampler::addKnownSample(Edge& edge, double fraction, std::span<const AdvectedPoint> images) {
  const int sample = static_cast<int>(edge.samples.size()), first = static_cast<int>(edge.images.size());
  edge.samples.push_back({fraction});
  for (const AdvectedPoint& at : images) addImage(edge, sample, at, 1);
  edge.image.leavesSurface |= images.front().leftSurface;
  return first;
}

void EdgeImageSampler::addImage(Edge& edge, int sample, const AdvectedPoint& at, int steps) {
  const int image = static_cast<int>(edge.images.size());
  Sample& of = edge.samples[sample];
  if (of.image != kNone) edge.images[of.image].next = image;
  of.image = image;
  of.step += steps;
  edge.images.push_back({at});
}

SurfacePoint EdgeImageSampler::pointAt(const Edge& edge, double fraction) const {
  SurfacePoint p{TriangleMesh::face(edge.halfedge)};
  const int i = TriangleMesh::corner(edge.halfedge);
  p.barycentric[i] = 1.0 - fraction;
  p.barycentric[(i + 1) % 3] = fraction;
  return p;
}

// Intervals ----------------------------------------------------------------------------------------------------------

/// Adds the interval between two samples, to be followed from a step on.
void EdgeImageSampler::addInterval(std::size_t slot, Node a, Node b, int step, int level,
                                   std::optional<double> deviation) {
  Edge& edge = slots_[slot];
  const int middle = static_cast<int>(edge.samples.size()), interval = static_cast<int>(edge.intervals.size());
  edge.samples.push_back({0.5 * (edge.samples[a.sample].fraction + edge.samples[b.sample].fraction)});
  const double half = 0.5 * flow_->mesh().edgeLength(edges_[edge.number].edge);
  edge.intervals.push_back({{a, {middle, kNone}, b}, {false, true, false}, step, level, deviation, {half, half}});
  ++edge.openIntervals;
  ++traces_;
  fetchImages(slot, interval);
}

/// Follows the image of an interval until it is enclosed after the last step or outside the windows, is halved, or has
/// to wait for an image.
void EdgeImageSampler::advanceInterval(std::size_t slot, int number) {
  Edge& edge = slots_[slot];
  while (edge.isCrowded ? !isWaiting(edge, number) : fetchImages(slot, number)) {
    Interval& interval = edge.intervals[number];
    const Verdict verdict = edge.isCrowded ? Verdict::Done : judge(edge, interval);
    if (verdict == Verdict::NextStep) {
      ++interval.step;
      interval.isBehind.fill(true);
      continue;
    }
    if (verdict == Verdict::Halve) halve(slot, Interval(interval));
    --edge.openIntervals;
    return;
  }
}

bool EdgeImageSampler::isWaiting(const Edge& edge, int number) const {
  const auto& nodes = edge.intervals[number].nodes;
  return std::any_of(nodes.begin(), nodes.end(), [&](const Node& node) {
    const auto& [one, other] = edge.samples[node.sample].waiting;
    return one == number || other == number;
  });
}

/// Brings the nodes to the interval's step; queues the samples that are not there yet. False: the interval has to wait.
bool EdgeImageSampler::fetchImages(std::size_t slot, int number) {
  Edge& edge = slots_[slot];
  Interval& interval = edge.intervals[number];
  bool all = true;
  for (int i = 0; i < 3; ++i) {
    if (!interval.isBehind[i]) continue;
    auto& [index, image] = interval.nodes[i];
    Sample& sample = edge.samples[index];
    if (image != kNone && edge.images[image].next == kNone && edge.images[image].at.leftSurface) {
      addImage(edge, index, AdvectedPoint(edge.images[image].at), 1);
    }
    const int next = image == kNone ? sample.image : edge.images[image].next;
    if (next != kNone) {
      image = next;
      interval.isBehind[i] = false;
      edge.image.leavesSurface |= edge.images[next].at.leftSurface;
      continue;
    }
    all = false;
    if (!sample.isQueued) queue_.push_back({slot, index, interval.step - sample.step});
    sample.isQueued = true;
    auto& [one, other] = sample.waiting;
    if (one != number && other != number) (one == kNone ? one : other) = number;
  }
  return all;
}

void EdgeImageSampler::halve(std::size_t slot, const Interval& interval) {
  Edge& edge = slots_[slot];
  const auto& [a, middle, b] = interval.nodes;
  const bool isFull = edge.samples.size() >= maxSamples_;
  if (isFull && !isAlone_) {
    edge.isCrowded = true;
  } else if (isFull || interval.level == kMaxLevel) {
    bridge(edge, a, middle, interval.step);
    bridge(edge, middle, b, interval.step);
  } else {
    std::optional<double> deviation = interval.deviation;
    if (deviation) *deviation *= kInheritedDeviation;
    addInterval(slot, a, middle, interval.step, interval.level + 1, deviation);
    addInterval(slot, middle, b, interval.step, interval.level + 1, deviation);
  }
}

/// Whether the image of an interval is enclosed at its step; collects its faces where they count.
EdgeImageSampler::Verdict EdgeImageSampler::judge(Edge& edge, Interval& interval) {
  const auto at = [&](int i) -> const AdvectedPoint& { return edge.images[interval.nodes[i].image].at; };
  const AdvectedPoint &a = at(0), &middle = at(1), &b = at(2);
  if (a.leftSurface && middle.leftSurface && b.leftSurface && interval.level >= kMaxLevelOutside) return Verdict::Done;
  const ChordShape shape = chordShape(flow_->faces(), a.point, middle.point, b.point);
  if (!shape.isComparable()) {
    interval.deviation.reset();
    return Verdict::Halve;
  }
  updateDeviation(interval, {&a, &middle, &b}, shape);
  const double deviation = *interval.deviation;
  const bool isLast = interval.step == steps_;
  const double maxDeviation = isLast ? kMaxDeviation : kMaxDeviationBefore;
  if (deviation > maxDeviation * shape.faceSize || shape.longestChord > kMaxChord * shape.faceSize) {
    return Verdict::Halve;
  }
  if (!isLast && windows_ == nullptr) return Verdict::NextStep;
  const double radius = kRadiusFactor * std::max({a.radius, middle.radius, b.radius});
  collectFaces(
      a, middle, b, shape,
      kDeviationPadding * deviation + kChordPadding * shape.longestChord + kFacePadding * shape.faceSize + radius);
  if (!isInWindow(interval.step)) return Verdict::Done;
  if (!isLast) return Verdict::NextStep;
  keepFaces(edge);
  return Verdict::Done;
}

/// Carries the deviation over the step that led to the shape. A half starts with what it inherited at its first step,
/// which its parent has judged already.
void EdgeImageSampler::updateDeviation(Interval& interval, const std::array<const AdvectedPoint*, 3>& at,
                                       const ChordShape& shape) const {
  double deviation = interval.deviation.value_or(kDefaultDeviation * shape.longestChord);
  if (!interval.isFirstStep || interval.level == 0) {
    deviation = deviationAfterStep(
        *flow_, tau_ / steps_, windows_ != nullptr ? DeviationModel::InWindow : DeviationModel::Careful,
        {deviation, interval.chords}, {at[0]->point.face, at[1]->point.face, at[2]->point.face}, shape);
  }
  interval.isFirstStep = false;
  interval.chords = shape.chords;
  interval.deviation = std::max(deviation, shape.deviation + shape.spread);
}

/// Finds the faces near the chords from the middle to the two ends. What has left the surface counts where it left.
void EdgeImageSampler::collectFaces(const AdvectedPoint& a, const AdvectedPoint& middle, const AdvectedPoint& b,
                                    const ChordShape& shape, double padding) {
  found_.clear();
  foundExit_ = false;
  const auto onBoundary = [&](Index h) { foundExit_ |= flow_->flowsOut(h); };
  const auto addChords = [&](const AdvectedPoint& end, const Unfoldings& unfoldings, Complex inEnd) {
    if (end.leftSurface && middle.leftSurface) return;
    found_.push_back(end.point.face);
    for (int i = 0; i < unfoldings.count(); ++i) {
      near_.collect(middle.point.face, shape.middle, unfoldings[i](inEnd), padding, found_, onBoundary);
    }
  };
  addChords(a, shape.toA, shape.inA);
  addChords(b, shape.toB, shape.inB);
}

void EdgeImageSampler::keepFaces(Edge& edge) const {
  edge.image.leavesSurface |= foundExit_;
  edge.image.faces.insert(edge.image.faces.end(), found_.begin(), found_.end());
}

bool EdgeImageSampler::isInWindow(int step) const {
  if (windows_ == nullptr) return true;
  return std::any_of(found_.begin(), found_.end(), [&](Index f) { return windows_->contains(step, f); });
}

// Gaps between samples that are as close as they can be --------------------------------------------------------------

/// Adds the faces between the images of two neighbouring samples.
void EdgeImageSampler::bridge(Edge& edge, const Node& from, const Node& to, int step) {
  const auto imageAfterTau = [&](const Node& node) {
    AdvectedPoint at = edge.images[node.image].at;
    if (!at.leftSurface && step < steps_) at = forward_->advect(at, tau_ * (steps_ - step) / steps_);
    edge.image.leavesSurface |= at.leftSurface;
    return at;
  };
  const AdvectedPoint a = imageAfterTau(from), b = imageAfterTau(to);
  if (a.leftSurface && b.leftSurface) return;
  const double radius = kRadiusFactor * std::max(a.radius, b.radius);
  const ChordShape shape = chordShape(flow_->faces(), a.point, a.point, b.point);
  if (shape.isComparable() && shape.longestChord <= kMaxDeviation * shape.faceSize) {
    collectFaces(a, a, b, shape, shape.longestChord + radius);
    keepFaces(edge);
  } else if (a.leftSurface || b.leftSurface) {
    addTangentTrajectory(edge, edge.samples[a.leftSurface ? to.sample : from.sample].fraction);
  } else {
    addSeparatingTrajectories(edge, edge.samples[from.sample].fraction, edge.samples[to.sample].fraction, radius);
  }
}

/// One sample left the surface, its neighbour `staying` only touches the boundary. Between their images runs the
/// neighbour's own trajectory, as far as it passes the two faces of the edge before and after the sample.
void EdgeImageSampler::addTangentTrajectory(Edge& edge, double staying) {
  const TriangleMesh& mesh = flow_->mesh();
  const Index h = edge.halfedge, twin = mesh.twin(h);
  const auto isBesideEdge = [&](const TrajectoryPoint& p) {
    return p.point.face == TriangleMesh::face(h) || (twin != kNone && p.point.face == TriangleMesh::face(twin));
  };
  const SurfacePoint from = pointAt(edge, staying);
  const auto stay = [&](PointAdvector& advector) {
    double longest = 0.0;
    for (const TrajectoryPoint& p : advector.trajectory(from, tau_)) {
      longest = p.tau;
      if (!isBesideEdge(p)) break;
    }
    return longest;
  };
  const double before = stay(*backward_), after = stay(*forward_);
  for (const TrajectoryPoint& p : forward_->trajectory(from, tau_ + after)) {
    if (p.tau >= tau_ - before) edge.image.faces.push_back(p.point.face);
  }
}

/// Both samples stay, on trajectories that separate. Between their images lies what the two met from there on.
void EdgeImageSampler::addSeparatingTrajectories(Edge& edge, double a, double b, double radius) {
  const std::vector<TrajectoryPoint> ofA = forward_->trajectory(pointAt(edge, a), tau_);
  const std::vector<TrajectoryPoint> ofB = forward_->trajectory(pointAt(edge, b), tau_);
  std::size_t common = 0;
  while (common < std::min(ofA.size(), ofB.size()) && ofA[common].point.face == ofB[common].point.face) ++common;
  for (const auto* trajectory : {&ofA, &ofB}) {
    for (std::size_t i = common == 0 ? 0 : common - 1; i < trajectory->size(); ++i) {
      const auto& [face, at] = (*trajectory)[i].point;
      const Complex p = flow_->faces()[face].point(at);
      near_.collect(face, p, p, radius, edge.image.faces, [](Index) {});
    }
  }
}

}  // namespace stormfield
