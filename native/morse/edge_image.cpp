#include "morse/edge_image.h"

#include "tracing/dense_step.h"

#include <algorithm>
#include <cmath>

namespace stormfield {
namespace {

/// Halvings of an edge at most, and where both ends leave the surface: 2^-28 of an edge is what traces resolve.
constexpr int kDeepest = 28, kDeepestOutside = 6;
/// Samples of one edge at most; beyond, gaps are bridged.
constexpr std::size_t kMostSamples = 5000;
/// How far an image may leave its chords, in face sizes, and how long these may be.
constexpr double kFlat = 0.25, kFlatOnTheWay = 0.4, kLongest = 1.5;
/// Of what an interval may leave its chords by, this part is left for its halves; where nothing can be seen, of chords.
constexpr double kLeft = 0.3, kUnseen = 0.1;
/// By how much a step bends chords, as a part of the gradient's turn; less in one face, where the field is all but
/// linear. And the most by which one step is taken to draw them out (its logarithm).
constexpr double kFed = 0.025, kFedInFace = 0.1, kMostGrowth = 3.0;
/// Where images are followed for long, in Morse sets, chords are taken to show this much of themselves.
constexpr double kMostInSet = 0.25;
/// Padding around chords: this part of how far images may leave them, and of chord and face size at least.
constexpr double kPadding = 1.0, kChordPadding = 0.01, kLeastPadding = 2e-3;

double faceSize(const FlatFace& face) {
  return std::sqrt(face.corner(1).real() * face.corner(2).imag());
}

}  // namespace

EdgeImageMaker::EdgeImageMaker(const TauFlow& flow, double tau, int steps, const SetWindows* windows,
                               const Progress* progress)
    : flow_(&flow),
      tau_(tau),
      windows_(windows),
      steps_(steps),
      forward_(flow.mover(Direction::Forward, progress)),
      backward_(flow.mover(Direction::Backward, progress)),
      near_(flow.faces()) {}

const EdgeImage& EdgeImageMaker::make(Index edge, const std::vector<Arrival>& tail, const std::vector<Arrival>& head) {
  halfedge_ = flow_->mesh().edgeHalfedge(edge);
  samples_ = 0;
  image_.faces.clear();
  image_.leaves = false;
  interval({0.0, 1, tail.front(), &tail}, {1.0, 1, head.front(), &head}, 1, 0, 0.0);
  std::sort(image_.faces.begin(), image_.faces.end());
  image_.faces.erase(std::unique(image_.faces.begin(), image_.faces.end()), image_.faces.end());
  return image_;
}

SurfacePoint EdgeImageMaker::pointAt(double s) const {
  SurfacePoint p{TriangleMesh::face(halfedge_)};
  const int i = TriangleMesh::corner(halfedge_);
  p.barycentric[i] = 1.0 - s;
  p.barycentric[(i + 1) % 3] = s;
  return p;
}

EdgeImageMaker::Sample EdgeImageMaker::sample(double s) {
  ++traces_;
  ++samples_;
  return {s, 0, {pointAt(s), false}};
}

void EdgeImageMaker::advance(Sample& sample, int step) {
  if (sample.step >= step) return;
  if (sample.known != nullptr && static_cast<int>(sample.known->size()) >= step) {
    sample.at = (*sample.known)[step - 1];
  } else if (!sample.at.left) {
    sample.at = forward_->move(sample.at.point, tau_ * (step - sample.step) / steps_);
  }
  sample.step = step;
  image_.leaves |= sample.at.left;
}

/// How far an image that was so far from its chords may be after the next step: the flow draws it apart, and bends the
/// chords where they are in more than one face.
double EdgeImageMaker::grown(double away, const Sample& a, const Sample& middle, const Sample& b,
                             double longest) const {
  const Index f = middle.at.point.face, left = a.at.point.face, right = b.at.point.face;
  const double step = tau_ / steps_;
  const double growth = std::max({flow_->growth(f), flow_->growth(left), flow_->growth(right)});
  const double bending = std::max({flow_->bending(f), flow_->bending(left), flow_->bending(right)});
  const bool inOneFace = f == left && f == right;
  const double fed = kFed * (inOneFace ? kFedInFace : 1.0) * std::min(bending * step, 1.0) * longest;
  const double grown = std::exp(std::min(growth * step, kMostGrowth)) * away + fed;
  return windows_ == nullptr ? grown : std::min(grown, kMostInSet * longest);
}

/// Follows the image of an interval of the edge from a step on, until it is enclosed at the end or out of sight.
/// away: by how much the image may leave the chords then.
void EdgeImageMaker::interval(Sample a, Sample b, int step, int level, double away) {
  Sample middle = sample(0.5 * (a.s + b.s));
  bool first = true;
  for (;; ++step) {
    for (Sample* s : {&a, &middle, &b}) advance(*s, step);
    if (a.at.left && middle.at.left && b.at.left && level >= kDeepestOutside) return;
    const Shape shape = shapeOf(a, middle, b);
    if (!shape.comparable()) {
      away = -1.0;
      break;
    }
    if (away < 0.0) away = kUnseen * shape.longest;
    if (!first || level == 0) away = grown(away, a, middle, b, shape.longest);
    first = false;
    away = std::max(away, shape.apart + shape.spread);
    const bool last = step == steps_;
    if (away > (last ? kFlat : kFlatOnTheWay) * shape.size || shape.longest > kLongest * shape.size) break;
    if (!last && windows_ == nullptr) continue;
    collect(a, middle, b, shape, kPadding * away + kChordPadding * shape.longest + kLeastPadding * shape.size);
    if (!staysInSight(step)) return;
    if (last) return keep();
  }
  if (level == kDeepest || samples_ >= kMostSamples) {
    bridge(a, middle);
    bridge(middle, b);
    return;
  }
  interval(a, middle, step, level + 1, kLeft * away);
  interval(middle, b, step, level + 1, kLeft * away);
}

EdgeImageMaker::Shape EdgeImageMaker::shapeOf(const Sample& a, const Sample& middle, const Sample& b) const {
  const FlatFaces& faces = flow_->faces();
  const SurfacePoint &pointA = a.at.point, &point = middle.at.point, &pointB = b.at.point;
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
  shape.longest =
      std::max(magnitude(shape.at - shape.toA[0](shape.inA)), magnitude(shape.at - shape.toB[0](shape.inB)));
  shape.spread = std::max(shape.toA.spread(shape.at, shape.inA), shape.toB.spread(shape.at, shape.inB));
  shape.size = faceSize(faces[point.face]);
  return shape;
}

/// Collects the faces near the chords from the middle to the two ends. What has left the surface counts where it left.
void EdgeImageMaker::collect(const Sample& a, const Sample& middle, const Sample& b, const Shape& shape,
                             double padding) {
  met_.clear();
  meetsExit_ = false;
  const auto onBoundary = [&](Index h) { meetsExit_ |= flow_->flowsOut(h); };
  const auto chords = [&](const Sample& end, const Unfoldings& ways, Complex inEnd) {
    if (end.at.left && middle.at.left) return;
    met_.push_back(end.at.point.face);
    for (int i = 0; i < ways.count(); ++i) {
      near_.collect(middle.at.point.face, shape.at, ways[i](inEnd), padding, met_, onBoundary);
    }
  };
  chords(a, shape.toA, shape.inA);
  chords(b, shape.toB, shape.inB);
}

void EdgeImageMaker::keep() {
  image_.leaves |= meetsExit_;
  image_.faces.insert(image_.faces.end(), met_.begin(), met_.end());
}

bool EdgeImageMaker::staysInSight(int step) const {
  if (windows_ == nullptr) return true;
  return std::any_of(met_.begin(), met_.end(), [&](Index f) { return windows_->holds(step, f); });
}

/// Between two samples as close as can be, whose images are apart.
void EdgeImageMaker::bridge(const Sample& from, const Sample& to) {
  Sample a = from, b = to;
  advance(a, steps_);
  advance(b, steps_);
  if (a.at.left && b.at.left) return;
  const Shape shape = shapeOf(a, a, b);
  if (shape.comparable() && shape.longest <= kFlat * shape.size) {
    collect(a, a, b, shape, shape.longest);
    keep();
  } else if (a.at.left || b.at.left) {
    addTorn(a.at.left ? b : a);
  } else {
    addParting(a, b);
  }
}

/// One sample left, its neighbour only touches the boundary: between them runs the neighbour's own trajectory, as far
/// as it goes through the two faces of the edge before and after the sample.
void EdgeImageMaker::addTorn(const Sample& staying) {
  const TriangleMesh& mesh = flow_->mesh();
  const Index twin = mesh.twin(halfedge_);
  const auto beside = [&](const Passage& p) {
    return p.point.face == TriangleMesh::face(halfedge_) || (twin != kNone && p.point.face == TriangleMesh::face(twin));
  };
  const SurfacePoint from = pointAt(staying.s);
  const auto stay = [&](Mover& mover) {
    double longest = 0.0;
    for (const Passage& p : mover.way(from, tau_)) {
      longest = p.tau;
      if (!beside(p)) break;
    }
    return longest;
  };
  const double before = stay(*backward_), after = stay(*forward_);
  for (const Passage& p : forward_->way(from, tau_ + after)) {
    if (p.tau >= tau_ - before) image_.faces.push_back(p.point.face);
  }
}

/// Both stay, on trajectories that part on the way: between their ends lies what they met after that.
void EdgeImageMaker::addParting(const Sample& a, const Sample& b) {
  const std::vector<Passage> wayA = forward_->way(pointAt(a.s), tau_), wayB = forward_->way(pointAt(b.s), tau_);
  std::size_t common = 0;
  while (common < std::min(wayA.size(), wayB.size()) && wayA[common].point.face == wayB[common].point.face) ++common;
  for (const auto* way : {&wayA, &wayB}) {
    for (std::size_t i = common == 0 ? 0 : common - 1; i < way->size(); ++i) {
      image_.faces.push_back((*way)[i].point.face);
    }
  }
}

}  // namespace stormfield
