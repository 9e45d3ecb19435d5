#include "topology/boundary_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "field/poincare_index.h"

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;

/// How many multiples of pi lie at or below an angle.
int halfTurns(double angle) {
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

class BoundaryWalk {
 public:
  explicit BoundaryWalk(const VectorField& field)
      : field_(field), mesh_(field.mesh()), turns_(edgeRotations(*field.charts, field.values.data())) {}

  void follow(const std::vector<Index>& loop) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Index h = loop[i], next = loop[(i + 1) % loop.size()];
      along(h);
      around(h, next);
    }
  }
  std::vector<BoundaryPoint> points;

 private:
  /// Angle from a halfedge to the field at its tail or head, in (-pi, pi]. Always computed in this one way, so that
  /// what is counted around a loop closes exactly.
  double fromTail(Index h) const { return angle(mesh_.tail(h), field_.charts->tailAngle(h)); }
  double fromHead(Index h) const { return angle(mesh_.head(h), field_.charts->headAngle(h)); }
  double angle(Index v, double edgeAngle) const {
    const Complex value = field_.values[v];
    const double a = std::atan2(value.imag() + 0.0, value.real() + 0.0) - edgeAngle;
    const double inside = a - 2.0 * kPi * std::round(a / (2.0 * kPi));
    return inside <= -kPi ? inside + 2.0 * kPi : inside;
  }
  /// Full turns between an angle that was followed and the same one computed anew.
  static int fullTurns(double followed, double anew) {
    return static_cast<int>(std::lround((followed - anew) / (2.0 * kPi)));
  }

  void along(Index h) {
    const Index e = mesh_.edge(h);
    const double from = fromTail(h), to = fromHead(h);
    const double turn = mesh_.edgeHalfedge(e) == h ? turns_[e] : -turns_[e];
    const int passed = halfTurns(to) + 2 * fullTurns(from + turn, to) - halfTurns(from);
    if (passed == 0) return;
    const double atTail = std::abs(field_.values[mesh_.tail(h)]) * std::sin(from);
    const double atHead = std::abs(field_.values[mesh_.head(h)]) * std::sin(to);
    const double fraction = atTail == atHead ? 0.5 : std::clamp(atTail / (atTail - atHead), 0.0, 1.0);
    add(h, fraction, -passed);
  }

  void around(Index h, Index next) {
    const double exterior = kPi - field_.charts->totalAngle(mesh_.head(h));
    const double from = fromHead(h), to = fromTail(next);
    add(next, 0.0, -(halfTurns(to) + 2 * fullTurns(from - exterior, to) - halfTurns(from)));
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
  std::vector<double> turns_;
};

}  // namespace

std::vector<BoundaryPoint> findBoundaryPoints(const VectorField& field) {
  const auto loops = boundaryLoops(field.mesh());
  if (loops.empty()) return {};
  BoundaryWalk walk(field);
  for (const auto& loop : loops) walk.follow(loop);
  return std::move(walk.points);
}

}  // namespace stormfield
