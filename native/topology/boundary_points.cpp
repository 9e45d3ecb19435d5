#include "topology/boundary_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "field/poincare_index.h"

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;

/// Number of the last multiple of pi at or below an angle.
int multiplesOfPi(double angle) {
  return static_cast<int>(std::floor(angle / kPi));
}

/// The boundary halfedges, each followed by the one that begins at its head.
std::vector<std::vector<Index>> boundaryLoops(const TriangleMesh& mesh) {
  std::vector<std::vector<Index>> loops;
  std::vector<char> seen(mesh.edgeCount(), 0);
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    if (mesh.twin(h) != kNone || seen[mesh.edge(h)] != 0) continue;
    loops.emplace_back();
    // The clockwise-most halfedge of a boundary vertex is the one on the boundary.
    for (Index at = h; seen[mesh.edge(at)] == 0; at = mesh.outgoing(mesh.head(at))) {
      seen[mesh.edge(at)] = 1;
      loops.back().push_back(at);
    }
  }
  return loops;
}

class LoopTangencies {
 public:
  explicit LoopTangencies(const VectorField& field)
      : field_(field), mesh_(field.mesh()), edgeRotations_(edgeRotations(*field.charts, field.values.data())) {}

  void addLoop(const std::vector<Index>& loop) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Index h = loop[i], next = loop[(i + 1) % loop.size()];
      addAlong(h);
      addAtHead(h, next);
    }
  }
  std::vector<BoundaryPoint> points;

 private:
  /// Angle from a halfedge to the field at its tail or head, in (-pi, pi]. Computed in this one way everywhere, so that
  /// the sum around a loop is an exact multiple of pi.
  double fromTail(Index h) const { return angle(mesh_.tail(h), field_.charts->tailAngle(h)); }
  double fromHead(Index h) const { return angle(mesh_.head(h), field_.charts->headAngle(h)); }
  double angle(Index v, double edgeAngle) const {
    const Complex value = field_.values[v];
    const double a = std::atan2(value.imag() + 0.0, value.real() + 0.0) - edgeAngle;
    const double inside = a - 2.0 * kPi * std::round(a / (2.0 * kPi));
    return inside <= -kPi ? inside + 2.0 * kPi : inside;
  }
  /// Full rotations between an angle that was followed continuously and the same angle wrapped to (-pi, pi].
  static int fullRotations(double followed, double wrapped) {
    return static_cast<int>(std::lround((followed - wrapped) / (2.0 * kPi)));
  }

  /// The multiples of pi that the angle passes along an edge, as one point where the field is tangent.
  void addAlong(Index h) {
    const Index e = mesh_.edge(h);
    const double from = fromTail(h), to = fromHead(h);
    const double rotation = mesh_.edgeHalfedge(e) == h ? edgeRotations_[e] : -edgeRotations_[e];
    const int passed = multiplesOfPi(to) + 2 * fullRotations(from + rotation, to) - multiplesOfPi(from);
    if (passed == 0) return;
    const double atTail = std::abs(field_.values[mesh_.tail(h)]) * std::sin(from);
    const double atHead = std::abs(field_.values[mesh_.head(h)]) * std::sin(to);
    const double fraction = atTail == atHead ? 0.5 : std::clamp(atTail / (atTail - atHead), 0.0, 1.0);
    add(h, fraction, -passed);
  }

  /// Those that it passes at the vertex between two edges, where the loop itself rotates by the exterior angle.
  void addAtHead(Index h, Index next) {
    const double exterior = kPi - field_.charts->totalAngle(mesh_.head(h));
    const double from = fromHead(h), to = fromTail(next);
    add(next, 0.0, -(multiplesOfPi(to) + 2 * fullRotations(from - exterior, to) - multiplesOfPi(from)));
  }

  void add(Index h, double fraction, int halfIndex) {
    if (halfIndex == 0) return;
    BoundaryPoint p;
    const int corner = TriangleMesh::corner(h);
    p.point.face = TriangleMesh::face(h);
    p.point.barycentric[corner] = 1.0 - fraction;
    p.point.barycentric[(corner + 1) % 3] = fraction;
    p.position = position(mesh_, p.point);
    p.halfIndex = halfIndex;
    points.push_back(p);
  }

  const VectorField& field_;
  const TriangleMesh& mesh_;
  std::vector<double> edgeRotations_;
};

}  // namespace

std::vector<BoundaryPoint> findBoundaryPoints(const VectorField& field) {
  const auto loops = boundaryLoops(field.mesh());
  if (loops.empty()) return {};
  LoopTangencies tangencies(field);
  for (const auto& loop : loops) tangencies.addLoop(loop);
  return std::move(tangencies.points);
}

}  // namespace stormfield
