#include "maps/detail/boundary_tangencies.h"

#include <algorithm>

#include "maps/geometry_map.h"

namespace stormfield {
namespace {

/// Trajectories are followed that pass so near to the boundary (barycentric), on its inner side.
constexpr double kInside = 1e-6;

class TangencyTracer {
 public:
  TangencyTracer(const PreparedFlow& flow, double tau, const Progress* progress)
      : flow_(flow),
        mesh_(flow.mesh()),
        tau_(tau),
        forward_(flow.advector(Direction::Forward, progress)),
        backward_(flow.advector(Direction::Backward, progress)) {}

  std::vector<std::pair<Index, Index>> run() {
    for (Index h = 0; h < mesh_.halfedgeCount(); ++h) {
      if (mesh_.twin(h) == kNone) touchAt(h);
    }
    std::sort(torn_.begin(), torn_.end());
    torn_.erase(std::unique(torn_.begin(), torn_.end()), torn_.end());
    return std::move(torn_);
  }

 private:
  /// On a boundary halfedge, or at its head.
  void touchAt(Index h) {
    const auto [tail, head] = endVectors(flow_.field(), h);
    const Index f = TriangleMesh::face(h);
    const int i = TriangleMesh::corner(h);
    if (tail.imag() * head.imag() < 0.0) {
      Eigen::Vector3d b = Eigen::Vector3d::Zero();
      b[i] = head.imag() / (head.imag() - tail.imag());
      b[(i + 1) % 3] = 1.0 - b[i];
      follow({f, (1.0 - kInside) * b + kInside * Eigen::Vector3d::Unit((i + 2) % 3)});
    }
    const Index v = mesh_.head(h);
    const EndVectors next = endVectors(flow_.field(), mesh_.outgoing(v));
    if (head.imag() * next.tail.imag() > 0.0) return;
    for (Index out = mesh_.outgoing(v); out != kNone; out = mesh_.nextOutgoing(out)) {
      const Eigen::Vector3d corner = Eigen::Vector3d::Unit(TriangleMesh::corner(out));
      follow({TriangleMesh::face(out), (1.0 - kInside) * corner + Eigen::Vector3d::Constant(kInside / 3.0)});
    }
  }

  /// What comes to the point after t is tau - t farther in the end.
  void follow(const SurfacePoint& touching) {
    const std::vector<TrajectoryPoint> before = backward_->trajectory(touching, tau_),
                                       after = forward_->trajectory(touching, tau_);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double earliest = tau_ - (i + 1 < before.size() ? before[i + 1].tau : before[i].tau);
      const double latest = tau_ - before[i].tau;
      for (std::size_t k = 0; k < after.size() && after[k].tau <= latest; ++k) {
        const double until = k + 1 < after.size() ? after[k + 1].tau : after[k].tau;
        if (until >= earliest) torn_.emplace_back(before[i].point.face, after[k].point.face);
      }
    }
  }

  const PreparedFlow& flow_;
  const TriangleMesh& mesh_;
  double tau_;
  std::unique_ptr<PointAdvector> forward_, backward_;
  std::vector<std::pair<Index, Index>> torn_;
};

}  // namespace

std::vector<std::pair<Index, Index>> boundaryTangencyEdges(const PreparedFlow& flow, double tau,
                                                           const Progress* progress) {
  return TangencyTracer(flow, tau, progress).run();
}

}  // namespace stormfield
