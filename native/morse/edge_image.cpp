#include "morse/edge_image.h"

#include "tracing/dense_step.h"

#include <algorithm>
#include <cmath>

namespace stormfield {
namespace {

/// Halvings of an edge at most, and where both ends leave the surface: 2^-28 of an edge is what traces resolve.
constexpr int kDeepest = 28, kDeepestOutside = 6;
/// Samples of one edge at most; beyond, gaps are bridged.
constexpr std::size_t kMostSamples = 50000;
/// Distance of the middle from the straight line that is still nearly in line, in face sizes.
constexpr double kFlat = 0.25;
/// Longest chord, in face sizes.
constexpr double kLongest = 0.75;
/// Padding around chords: this part of the distance of the middle, and of chord and face size at least.
constexpr double kPadding = 0.5, kChordPadding = 0.02, kLeastPadding = 2e-3;

double faceSize(const FlatFace& face) {
  return std::sqrt(face.corner(1).real() * face.corner(2).imag());
}

}  // namespace

EdgeImageMaker::EdgeImageMaker(const TauFlow& flow, double tau, const Progress* progress)
    : flow_(&flow),
      tau_(tau),
      forward_(flow.mover(Direction::Forward, progress)),
      backward_(flow.mover(Direction::Backward, progress)),
      near_(flow.faces()) {}

const EdgeImage& EdgeImageMaker::make(Index edge, const Arrival& tail, const Arrival& head) {
  halfedge_ = flow_->mesh().edgeHalfedge(edge);
  samples_ = 0;
  image_.faces.clear();
  image_.leaves = tail.left || head.left;
  interval({0.0, tail}, {1.0, head}, 0);
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
  const Sample result{s, forward_->move(pointAt(s), tau_)};
  image_.leaves |= result.at.left;
  return result;
}

void EdgeImageMaker::interval(const Sample& a, const Sample& b, int level) {
  const Sample middle = sample(0.5 * (a.s + b.s));
  if (accept(a, middle, b, level)) return;
  if (level == kDeepest || samples_ >= kMostSamples) {
    bridge(a, middle);
    bridge(middle, b);
    return;
  }
  interval(a, middle, level + 1);
  interval(middle, b, level + 1);
}

bool EdgeImageMaker::accept(const Sample& a, const Sample& middle, const Sample& b, int level) {
  if (a.at.left && middle.at.left && b.at.left && level >= kDeepestOutside) return true;
  return enclose(a.at, middle.at, b.at);
}

/// Collects the faces near the chords from the middle to the two ends, unless these are too far or not in line. What
/// has left the surface counts where it left.
bool EdgeImageMaker::enclose(const Arrival& a, const Arrival& middle, const Arrival& b) {
  const FlatFaces& faces = flow_->faces();
  const Index base = middle.point.face;
  const Unfoldings toA(faces, base, a.point.face), toB(faces, base, b.point.face);
  if (toA.count() == 0 || toB.count() == 0) return false;

  const Complex at = faces[base].point(middle.point.barycentric);
  const Complex inA = faces[a.point.face].point(a.point.barycentric);
  const Complex inB = faces[b.point.face].point(b.point.barycentric);
  double apart = std::numeric_limits<double>::infinity();
  const double longest = std::max(magnitude(at - toA[0](inA)), magnitude(at - toB[0](inB)));
  for (int i = 0; i < toA.count(); ++i) {
    for (int j = 0; j < toB.count(); ++j) {
      apart = std::min(apart, magnitude(at - 0.5 * (toA[i](inA) + toB[j](inB))));
    }
  }
  const double size = faceSize(faces[base]);
  const double spread = std::max(toA.spread(at, inA), toB.spread(at, inB));
  if (apart + spread > kFlat * size || longest > kLongest * size) return false;
  const double padding = kPadding * apart + spread + kChordPadding * longest + kLeastPadding * size;
  const auto onBoundary = [&](Index h) { image_.leaves |= flow_->flowsOut(h); };
  const auto chords = [&](const Arrival& end, const Unfoldings& ways, Complex inEnd) {
    if (end.left && middle.left) return;
    image_.faces.push_back(end.point.face);
    for (int i = 0; i < ways.count(); ++i) near_.collect(base, at, ways[i](inEnd), padding, image_.faces, onBoundary);
  };
  chords(a, toA, inA);
  chords(b, toB, inB);
  return true;
}

/// Between two samples as close as can be, whose images are apart.
void EdgeImageMaker::bridge(const Sample& a, const Sample& b) {
  if (a.at.left && b.at.left) return;
  if (enclose(a.at, a.at, b.at)) return;
  if (a.at.left || b.at.left) {
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
