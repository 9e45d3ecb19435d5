#include "maps/detail/face_transit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "field/poincare_index.h"
#include "maps/fixed_point_faces.h"
#include "maps/geometry_map.h"
#include "tracing/face_path.h"
#include "tracing/flow.h"
#include "tracing/integrator.h"

namespace stormfield {
namespace {

/// Largest error of one step, in mean edge lengths and as a fraction of the step: ten times below kSlack.
constexpr double kTolerance = 1e-6, kRelative = 1e-4;
/// Steps within one face after which a trajectory counts as staying: by closed forms, and by integration.
constexpr int kMaxSteps = 400, kMaxIntegrationSteps = 1000;
/// A trajectory is stationary when it moves by less than kStationary (barycentric) in a step, or, by integration, in
/// kStationarySteps steps.
constexpr double kStationary = 1e-7;
constexpr int kStationarySteps = 32;
/// Fraction of the speed at an edge's ends below which the field counts as zero between them: such a zero lies too near
/// to the edge for its two faces to agree on the side.
constexpr double kOpposed = 1e-6;
/// Distance (fraction of a side) from the end of a part of an edge at which its limit is taken. A trajectory that
/// touches an edge from inside rises above it by the square of the distance: 1e-3 gives 1e-6.
constexpr double kLimitDistance = 2e-6, kTangentLimitDistance = 1e-3;
/// Accuracy of the position of a jump, below kSlack, and largest number of jumps in one arc.
constexpr double kJumpAccuracy = 2e-6;
constexpr int kMaxJumps = 16;

EdgeFlow edgeFlowOf(const EndVectors& ends) {
  const double tail = ends.tail.imag(), head = ends.head.imag();
  if (holdsFixedPointOnEdge(ends)) return {};
  if (tail == 0.0 && head == 0.0) return {.along = ends.tail.real() > 0.0 ? 1 : -1};
  if (tail * head >= 0.0) return {tail + head > 0.0 ? 1 : -1, 1.0};
  const double signChange = tail / (tail - head);
  const double along = (1.0 - signChange) * ends.tail.real() + signChange * ends.head.real();
  if (std::abs(along) <= kOpposed * std::max(std::abs(ends.tail), std::abs(ends.head))) return {};
  // Flow that comes from outside the face and returns there touches it from outside.
  return {tail > 0.0 ? 1 : -1, signChange, tail * along < 0.0};
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

/// Arcs of entry and of exit, which alternate around a face, or one arc that is the whole boundary.
struct FaceTransit::Arcs {
  std::array<double, 8> begin{};
  std::array<char, 8> isExit{};
  int count = 0;

  void add(double at, bool exit) {
    if (count > 0 && (isExit[count - 1] != 0) == exit) return;
    begin[count] = at;
    isExit[count++] = exit ? 1 : 0;
  }
  BoundaryArc arc(int i) const {
    return count == 1 ? kWholeBoundary : BoundaryArc{begin[i], arcLength(begin[i], begin[(i + 1) % count])};
  }
  /// The arc of exit at a position, or the nearest one.
  BoundaryArc exitAt(double position) const {
    BoundaryArc best;
    double nearest = 4.0;
    for (int i = 0; i < count; ++i) {
      if (isExit[i] == 0) continue;
      const BoundaryArc exit = arc(i);
      const double fromBegin = arcLength(exit.begin, position);
      const double distance = fromBegin <= exit.length ? 0.0 : std::min(fromBegin - exit.length, 3.0 - fromBegin);
      if (distance < nearest) {
        nearest = distance;
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
      holdsFixedPoint_(stormfield::fixedPointFaces(*field_)),
      isCoarse_(mesh().faceCount(), 0),
      along_(prepareFaces(*faces_, SteadyFlow(field_->values.data(), 1.0))) {
  tbb::parallel_for(Index{0}, mesh().edgeCount(), [&](Index e) {
    ends_[e] = endVectors(*field_, mesh().edgeHalfedge(e));
    edges_[e] = edgeFlowOf(ends_[e]);
  });
  for (Index f = 0; f < mesh().faceCount(); ++f) {
    for (Index h = 3 * f; h < 3 * f + 3; ++h) isCoarse_[f] |= edges_[mesh().edge(h)].isOpen();
    isCoarse_[f] |= std::abs(poincare_[f]) > 1;
  }
}

FaceTransit::Arcs FaceTransit::arcs(Index f, Direction direction) const {
  Arcs result;
  for (int i = 0; i < 3; ++i) {
    const Index h = TriangleMesh::halfedge(f, i), e = mesh().edge(h);
    const auto [sign, signChange, touchesInside, along] = edges_[e];
    const bool canonical = mesh().edgeHalfedge(e) == h, changes = signChange < 1.0;
    // Along h: on a halfedge that is not canonical, the part beyond the sign change comes first.
    const bool leavesFirst = canonical ? sign < 0 : (changes ? sign < 0 : sign > 0);
    const bool forward = direction == Direction::Forward;
    result.add(i, leavesFirst == forward);
    if (changes) result.add(i + (canonical ? signChange : 1.0 - signChange), leavesFirst != forward);
  }
  // The last arc continues beyond corner 0.
  if (result.count > 1 && result.isExit[0] == result.isExit[result.count - 1]) {
    result.begin[0] = result.begin[result.count - 1];
    --result.count;
  }
  return result;
}

BoundaryArc FaceTransit::exitArcAt(Index f, double position, Direction direction) const {
  return arcs(f, direction).exitAt(position);
}

std::optional<BoundaryArc> FaceTransit::commonExitArc(Index f, ExitPosition a, ExitPosition b) const {
  if (!a.exists() || !b.exists()) return std::nullopt;
  const Arcs all = arcs(f, Direction::Forward);
  const BoundaryArc arc = all.exitAt(*a);
  if (all.exitAt(*b).begin != arc.begin) return std::nullopt;
  return arc;
}

bool FaceTransit::isSameArc(Index f, ExitPosition a, ExitPosition b, Direction direction) const {
  if (!a.exists() || !b.exists()) return a == b;
  const Arcs all = arcs(f, direction);
  return all.exitAt(*a).begin == all.exitAt(*b).begin;
}

ExitPosition FaceTransit::exitOf(Index f, double position, Direction direction) const {
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
  for (int i = 0; i < kMaxSteps; ++i) {
    FaceStep step;
    if (!stepThroughFace(*flow, entry, inside, limits, step)) return exitByIntegration(f, {f, inside}, direction);
    if (step.exit.side >= 0) return step.exit.side + step.exit.fraction;
    // A trajectory that is slow near a saddle passes it in time.
    const bool isStationary =
        poincare_[f] >= 0 && entry.side < 0 && (step.barycentric - inside).cwiseAbs().maxCoeff() < kStationary;
    if (isStationary) return kNoExit;
    entry = {};
    inside = step.barycentric;
  }
  return kNoExit;
}

bool FaceTransit::touchesAt(Index f, double position) const {
  const double at = std::fmod(position, 3.0);
  if (at == std::floor(at)) return false;  // flow around a corner cuts it off
  const Index h = TriangleMesh::halfedge(f, static_cast<int>(at)), e = mesh().edge(h);
  return edges_[e].signChange < 1.0 && edges_[e].touchesInside == (mesh().edgeHalfedge(e) == h);
}

/// Let s be the sine of the angle between flow and side, which grows by g along the side. An error d across the flow is
/// one of d / s along the side, and of the order of sqrt(d / g) where s vanishes. The slack falls more slowly than the
/// position advances, so that of two arcs the wider one stays wider.
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
  // Not beyond the corner: there the flow meets another side at another angle.
  const double before = std::min(slackAt(f, arc.begin), arc.begin - std::floor(arc.begin) + kSlack);
  const double after = std::min(slackAt(f, end), std::ceil(end) - end + kSlack);
  return {arc.begin - before, before + arc.length + after};
}

ExitPosition FaceTransit::exitLimit(Index f, double end, double otherEnd) const {
  const BoundaryArc entry = exitArcAt(f, 0.5 * (end + otherEnd), Direction::Backward);
  const double fromBegin = arcLength(entry.begin, std::fmod(end, 3.0));
  const bool isEndOfArc = fromBegin == 0.0 || std::abs(fromBegin - entry.length) < 1e-14;
  double distance = kLimitDistance;
  if (isEndOfArc && entry.length < 3.0) {
    if (!touchesAt(f, end)) return end;  // the trajectory cuts off the corner
    distance = kTangentLimitDistance;
  }
  return exitOf(f, end + std::min(distance / std::abs(otherEnd - end), 0.1) * (otherEnd - end));
}

/// Where no closed form holds: near a vertex, and where the trajectory touches an edge.
ExitPosition FaceTransit::exitByIntegration(Index f, const SurfacePoint& from, Direction direction) const {
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
        if (++steps % kStationarySteps != 0) return true;
        const bool isStationary = poincare_[f] >= 0 && (p.barycentric - before).cwiseAbs().maxCoeff() < kStationary;
        before = p.barycentric;
        return !isStationary && steps < kMaxIntegrationSteps;
      });
  if (end.point.face == f && end.reason != StopReason::Boundary) return kNoExit;
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
  // Across a vertex or the boundary of the surface: at its last point, on the nearest side.
  int least = 0;
  for (int i = 1; i < 3; ++i) {
    if (last.barycentric[i] < last.barycentric[least]) least = i;
  }
  const int i = (least + 1) % 3;
  return i + last.barycentric[(i + 1) % 3] / (last.barycentric[i] + last.barycentric[(i + 1) % 3]);
}

std::vector<ContinuousArc> FaceTransit::continuousArcs(Index f, Direction direction) const {
  const Arcs all = arcs(f, direction);
  std::vector<ContinuousArc> result;
  for (int i = 0; i < all.count; ++i) {
    if (all.isExit[i] != 0) continue;
    const auto [begin, length] = all.arc(i);
    if (all.count == 1) return {{kWholeBoundary, kNoExit, kNoExit}};  // whatever enters stays
    const auto exit = [&](double s) { return exitOf(f, std::fmod(begin + s, 3.0), direction); };
    const double distance = std::min(kLimitDistance, 0.1 * length);
    double from = 0.0;
    ExitPosition exitOfFrom = exit(distance);
    const ExitPosition exitOfEnd = exit(length - distance);
    for (int jumps = 0; jumps < kMaxJumps && !isSameArc(f, exitOfFrom, exitOfEnd, direction); ++jumps) {
      double low = from, high = length;
      ExitPosition exitOfLow = exitOfFrom, exitOfHigh = exitOfEnd;
      while (high - low > kJumpAccuracy) {
        const double middle = 0.5 * (low + high);
        const ExitPosition exitOfMiddle = exit(middle);
        const bool isBefore = isSameArc(f, exitOfLow, exitOfMiddle, direction);
        (isBefore ? low : high) = middle;
        (isBefore ? exitOfLow : exitOfHigh) = exitOfMiddle;
      }
      const double jump = 0.5 * (low + high);
      result.push_back({{std::fmod(begin + from, 3.0), jump - from}, exitOfFrom, exitOfLow});
      from = jump;
      exitOfFrom = exitOfHigh;
    }
    result.push_back({{std::fmod(begin + from, 3.0), length - from}, exitOfFrom, exitOfEnd});
  }
  return result;
}

}  // namespace stormfield
