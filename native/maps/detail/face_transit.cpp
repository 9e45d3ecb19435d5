#include "maps/detail/face_transit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "field/poincare_index.h"
#include "maps/fixed_point_faces.h"
#include "maps/geometry_map.h"
#include "tracing/face_path.h"
#include "tracing/flow.h"
#include "tracing/integrator.h"

namespace stormfield {
namespace {

/// Largest error of one step, in mean edges and as a part of its length.
constexpr double kTolerance = 1e-6, kRelative = 1e-4;
/// Steps within one face after which a trajectory is taken to stay, and the change by which it no longer moves.
constexpr int kMostSteps = 400, kMostSlowSteps = 1000, kSlowRound = 32;
constexpr double kStill = 1e-7;
/// Part of the speed at an edge's ends below which the field is zero in between.
constexpr double kOpposed = 1e-6;
/// How far from the end of a part of an edge its limit is taken; a trajectory that touches an edge from within rises
/// above it by the square.
constexpr double kWithin = 2e-6, kWithinTouch = 1e-3;
/// How closely jumps are found, and how many at most.
constexpr double kJump = 2e-6;
constexpr int kMostJumps = 16;

EdgeFlow edgeFlowOf(const EndVectors& ends) {
  const double tail = ends.tail.imag(), head = ends.head.imag();
  if (holdsFixedPointOnEdge(ends)) return {};
  if (tail == 0.0 && head == 0.0) return {.along = ends.tail.real() > 0.0 ? 1 : -1};
  if (tail * head >= 0.0) return {tail + head > 0.0 ? 1 : -1, 1.0};
  const double turn = tail / (tail - head), along = (1.0 - turn) * ends.tail.real() + turn * ends.head.real();
  // A fixed point rests on the edge, or too near for its two faces to tell where.
  if (std::abs(along) <= kOpposed * std::max(std::abs(ends.tail), std::abs(ends.head))) return {};
  // Where flow along the edge comes from outside a face and goes there, it touches the face from outside.
  return {tail > 0.0 ? 1 : -1, turn, tail * along < 0.0};
}

double around(double from, double to) {
  const double way = to - from;
  return way < 0.0 ? way + 3.0 : way;
}

SurfacePoint pointAt(Index f, double position) {
  SurfacePoint p{f};
  const int i = std::min(2, static_cast<int>(position));
  const double fraction = position - i;
  p.barycentric[i] = 1.0 - fraction;
  p.barycentric[(i + 1) % 3] = fraction;
  return p;
}

}  // namespace

/// Arcs of entry and of exit in turn around a face, or one arc that is the whole circle.
struct FaceTransit::Arcs {
  std::array<double, 8> begin{};
  std::array<char, 8> exits{};
  int count = 0;

  void add(double at, bool exit) {
    if (count > 0 && (exits[count - 1] != 0) == exit) return;
    begin[count] = at;
    exits[count++] = exit ? 1 : 0;
  }
  BoundaryArc arc(int i) const {
    return count == 1 ? BoundaryArc{0.0, 3.0} : BoundaryArc{begin[i], around(begin[i], begin[(i + 1) % count])};
  }
  BoundaryArc exitAt(double position) const {
    BoundaryArc best;
    double nearest = 4.0;
    for (int i = 0; i < count; ++i) {
      if (exits[i] == 0) continue;
      const BoundaryArc exit = arc(i);
      const double in = around(exit.begin, position);
      const double away = in <= exit.length ? 0.0 : std::min(in - exit.length, 3.0 - in);
      if (away < nearest) {
        nearest = away;
        best = exit;
      }
    }
    return best;
  }
};

FaceTransit::FaceTransit(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field)
    : faces_(std::move(faces)),
      field_(std::move(field)),
      ends_(mesh().edgeCount()),
      edges_(mesh().edgeCount()),
      poincare_(poincareIndices(*field_)),
      resting_(stormfield::fixedPointFaces(*field_)),
      coarse_(mesh().faceCount(), 0),
      along_(prepareFaces(*faces_, SteadyFlow(field_->values.data(), 1.0))) {
  tbb::parallel_for(Index{0}, mesh().edgeCount(), [&](Index e) {
    ends_[e] = endVectors(*field_, mesh().edgeHalfedge(e));
    edges_[e] = edgeFlowOf(ends_[e]);
  });
  for (Index f = 0; f < mesh().faceCount(); ++f) {
    for (Index h = 3 * f; h < 3 * f + 3; ++h) coarse_[f] |= edges_[mesh().edge(h)].isOpen();
    coarse_[f] |= std::abs(poincare_[f]) > 1;
  }
}

FaceTransit::Arcs FaceTransit::arcs(Index f, Direction direction) const {
  Arcs result;
  for (int i = 0; i < 3; ++i) {
    const Index h = TriangleMesh::halfedge(f, i), e = mesh().edge(h);
    const auto [sign, turn, touchesWithin, along] = edges_[e];
    const bool canonical = mesh().edgeHalfedge(e) == h, turns = turn < 1.0;
    // Along h: against a halfedge that is not canonical, the part beyond the turn comes first.
    const bool leavesFirst = canonical ? sign < 0 : (turns ? sign < 0 : sign > 0);
    const bool forward = direction == Direction::Forward;
    result.add(i, leavesFirst == forward);
    if (turns) result.add(i + (canonical ? turn : 1.0 - turn), leavesFirst != forward);
  }
  // The last arc goes on beyond corner 0.
  if (result.count > 1 && result.exits[0] == result.exits[result.count - 1]) {
    result.begin[0] = result.begin[result.count - 1];
    --result.count;
  }
  return result;
}

BoundaryArc FaceTransit::arcOf(Index f, double position, Direction direction) const {
  return arcs(f, direction).exitAt(position);
}

std::pair<BoundaryArc, bool> FaceTransit::arcOfBoth(Index f, double a, double b) const {
  if (a == kRest || b == kRest) return {{}, false};
  const Arcs all = arcs(f, Direction::Forward);
  const BoundaryArc arc = all.exitAt(a);
  return {arc, all.exitAt(b).begin == arc.begin};
}

bool FaceTransit::sameArc(Index f, double a, double b, Direction direction) const {
  if (a == kRest || b == kRest) return a == b;
  const Arcs all = arcs(f, direction);
  return all.exitAt(a).begin == all.exitAt(b).begin;
}

double FaceTransit::leaves(Index f, double position, Direction direction) const {
  const double rate = direction == Direction::Forward ? 1.0 : -1.0;
  FaceFlow own;
  const FaceFlow* flow = &along_[f];
  if (direction == Direction::Backward) {
    own = FaceFlow((*faces_)[f], SteadyFlow(field_->values.data(), rate).vertexValues((*faces_)[f]));
    flow = &own;
  }
  const StepLimits limits{kTolerance * mesh().meanEdgeLength(), kRelative, 0.0};
  const int side = std::min(2, static_cast<int>(position));
  SidePoint entry{side, position - side};
  Eigen::Vector3d inside = pointAt(f, position).barycentric;
  for (int i = 0; i < kMostSteps; ++i) {
    FaceStep step;
    if (!stepThroughFace(*flow, entry, inside, limits, step)) return leavesSlowly(f, {f, inside}, direction);
    if (step.exit.side >= 0) return step.exit.side + step.exit.fraction;
    // Past a saddle everything goes on, in time.
    const bool still =
        poincare_[f] >= 0 && entry.side < 0 && (step.barycentric - inside).cwiseAbs().maxCoeff() < kStill;
    if (still) return kRest;
    entry = {};
    inside = step.barycentric;
  }
  return kRest;
}

/// Else flow goes around the point outside: it cuts off corners always.
bool FaceTransit::touchesAt(Index f, double position) const {
  const double at = std::fmod(position, 3.0);
  if (at == std::floor(at)) return false;
  const Index h = TriangleMesh::halfedge(f, static_cast<int>(at)), e = mesh().edge(h);
  return edges_[e].turn < 1.0 && edges_[e].touchesWithin == (mesh().edgeHalfedge(e) == h);
}

/// With a sine s of the angle between flow and side that grows by g along the side, an error d across the flow is one
/// of d / s along it; where s vanishes, of the order of sqrt(d / g). It falls more slowly than the position goes on, so
/// that a wider arc stays wider.
double FaceTransit::slackAt(Index f, double position) const {
  const double at = position < 0.0 ? position + 3.0 : position < 3.0 ? position : position - 3.0;
  const int side = std::min(2, static_cast<int>(at));
  const Index h = TriangleMesh::halfedge(f, side), e = mesh().edge(h);
  const double fraction = at - side, t = mesh().edgeHalfedge(e) == h ? fraction : 1.0 - fraction;
  const auto [tail, head] = ends_[e];
  const double along = (1.0 - t) * tail.real() + t * head.real(), across = (1.0 - t) * tail.imag() + t * head.imag();
  const double speed = std::sqrt(along * along + across * across);
  const double growth = std::abs(head.imag() - tail.imag());
  double least = std::max(std::abs(across), kSlack * speed);
  if (least * least < 4.0 * kSlack * growth * speed) least = 2.0 * std::sqrt(kSlack * growth * speed);
  return least > 0.0 ? kSlack * speed / least : kSlack;
}

BoundaryArc FaceTransit::widened(Index f, const BoundaryArc& arc) const {
  const double end = arc.begin + arc.length;
  // Beyond the corner the flow meets another side at another angle.
  const double before = std::min(slackAt(f, arc.begin), arc.begin - std::floor(arc.begin) + kSlack);
  const double after = std::min(slackAt(f, end), std::ceil(end) - end + kSlack);
  return {arc.begin - before, before + arc.length + after};
}

double FaceTransit::leavesFromEnd(Index f, double end, double otherEnd) const {
  const BoundaryArc entry = arcOf(f, 0.5 * (end + otherEnd), Direction::Backward);
  const double before = around(entry.begin, std::fmod(end, 3.0));
  const bool ends = before == 0.0 || std::abs(before - entry.length) < 1e-14;
  double within = kWithin;
  if (ends && entry.length < 3.0) {
    if (!touchesAt(f, end)) return end;
    within = kWithinTouch;
  }
  return leaves(f, end + std::min(within / std::abs(otherEnd - end), 0.1) * (otherEnd - end));
}

/// Where no closed form holds: near a vertex, touching an edge.
double FaceTransit::leavesSlowly(Index f, const SurfacePoint& from, Direction direction) const {
  const double rate = direction == Direction::Forward ? 1.0 : -1.0;
  TraceOptions options;
  options.direction = direction;
  options.tolerance = kTolerance;
  Integrator<SteadyFlow> integrator(*faces_, SteadyFlow(field_->values.data(), rate), options, 0.0);
  SurfacePoint last = from;
  Eigen::Vector3d before = from.barycentric;
  int steps = 0;
  const TraceEnd end =
      integrator.run(from, 0.0, std::numeric_limits<double>::infinity(), [&](const SurfacePoint& p, double) {
        if (p.face != f) return false;
        last = p;
        if (++steps % kSlowRound != 0) return true;
        const bool still = poincare_[f] >= 0 && (p.barycentric - before).cwiseAbs().maxCoeff() < kStill;
        before = p.barycentric;
        return !still && steps < kMostSlowSteps;
      });
  if (end.point.face == f && end.reason != StopReason::Boundary) return kRest;
  if (end.point.face != f) {
    for (int i = 0; i < 3; ++i) {
      const Index twin = mesh().twin(TriangleMesh::halfedge(f, i));
      if (twin == kNone || TriangleMesh::face(twin) != end.point.face) continue;
      const int j = TriangleMesh::corner(twin);
      const double tail = end.point.barycentric[j], head = end.point.barycentric[(j + 1) % 3];
      if (end.point.barycentric[(j + 2) % 3] > 1e-6) continue;  // across a vertex
      return i + tail / (tail + head);
    }
  } else {
    last = end.point;
  }
  // Over a vertex or the boundary of the surface: where it was last.
  int least = 0;
  for (int i = 1; i < 3; ++i) {
    if (last.barycentric[i] < last.barycentric[least]) least = i;
  }
  const int i = (least + 1) % 3;
  return i + last.barycentric[(i + 1) % 3] / (last.barycentric[i] + last.barycentric[(i + 1) % 3]);
}

std::vector<ContinuousArc> FaceTransit::parts(Index f, Direction direction) const {
  const Arcs all = arcs(f, direction);
  std::vector<ContinuousArc> result;
  for (int i = 0; i < all.count; ++i) {
    if (all.exits[i] != 0) continue;
    const auto [begin, length] = all.arc(i);
    if (all.count == 1) return {{{0.0, 3.0}, kRest, kRest}};  // whatever enters stays
    const auto image = [&](double s) { return leaves(f, std::fmod(begin + s, 3.0), direction); };
    const double within = std::min(kWithin, 0.1 * length);
    double from = 0.0, imageFrom = image(within);
    const double imageTo = image(length - within);
    for (int jumps = 0; jumps < kMostJumps && !sameArc(f, imageFrom, imageTo, direction); ++jumps) {
      double low = from, high = length, imageLow = imageFrom, imageHigh = imageTo;
      while (high - low > kJump) {
        const double middle = 0.5 * (low + high), there = image(middle);
        const bool before = sameArc(f, imageLow, there, direction);
        (before ? low : high) = middle;
        (before ? imageLow : imageHigh) = there;
      }
      const double jump = 0.5 * (low + high);
      result.push_back({{std::fmod(begin + from, 3.0), jump - from}, imageFrom, imageLow});
      from = jump;
      imageFrom = imageHigh;
    }
    result.push_back({{std::fmod(begin + from, 3.0), length - from}, imageFrom, imageTo});
  }
  return result;
}

}  // namespace stormfield
