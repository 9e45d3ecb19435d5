#include "maps/detail/boundary_tangencies.h"

#include <algorithm>

#include "maps/geometry_map.h"

namespace stormfield {
namespace {

/// Barycentric distance from the boundary of the trajectory that stands for a tangent one, on its inner side: 1e-6 of a
/// face is small beside the padding of images (edge_image.h) and large beside the round-off of a trace.
constexpr double kInside = 1e-6;

class TangencyTracer {
 public:
  TangencyTracer(const PreparedFlow& flow, double tau, const Progress* progress)
      : flow_(flow),
        mesh_(flow.mesh()),
        tau_(tau),
        forward_(flow.advector(Direction::Forward, progress)),
        backward_(flow.advector(Direction::Backward, progress)) {}

  std::vector<TangencyEdge> run() {
    for (Index h = 0; h < mesh_.halfedgeCount(); ++h) {
      if (mesh_.twin(h) != kNone) continue;
      traceTangencyInside(h);
      traceTangencyAtHead(h);
    }
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    return std::move(edges_);
  }

 private:
  /// Where the component across a boundary halfedge changes its sign between the ends.
  void traceTangencyInside(Index h) {
    const auto [tail, head] = endVectors(flow_.field(), h);
    if (!(tail.imag() * head.imag() < 0.0)) return;
    const int i = TriangleMesh::corner(h);
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    b[i] = head.imag() / (head.imag() - tail.imag());
    b[(i + 1) % 3] = 1.0 - b[i];
    addEdges({TriangleMesh::face(h), (1.0 - kInside) * b + kInside * Eigen::Vector3d::Unit((i + 2) % 3)});
  }

  /// Where it does so between a boundary halfedge and the next one.
  void traceTangencyAtHead(Index h) {
    const Index v = mesh_.head(h);
    const double before = endVectors(flow_.field(), h).head.imag();
    const double after = endVectors(flow_.field(), mesh_.outgoing(v)).tail.imag();
    if (before * after > 0.0) return;
    for (Index out = mesh_.outgoing(v); out != kNone; out = mesh_.nextOutgoing(out)) {
      const Eigen::Vector3d corner = Eigen::Vector3d::Unit(TriangleMesh::corner(out));
      addEdges({TriangleMesh::face(out), (1.0 - kInside) * corner + Eigen::Vector3d::Constant(kInside / 3.0)});
    }
  }

  /// Adds, for each face that the trajectory through the point passes before it, the faces where it is tau later: a
  /// stay from tau - latest to tau - earliest before the point leads to one from earliest to latest after it.
  void addEdges(const SurfacePoint& tangency) {
    const std::vector<TrajectoryPoint> before = backward_->trajectory(tangency, tau_);
    const std::vector<TrajectoryPoint> after = forward_->trajectory(tangency, tau_);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double earliest = tau_ - (i + 1 < before.size() ? before[i + 1].tau : before[i].tau);
      const double latest = tau_ - before[i].tau;
      for (std::size_t k = 0; k < after.size() && after[k].tau <= latest; ++k) {
        const double until = k + 1 < after.size() ? after[k + 1].tau : after[k].tau;
        if (until >= earliest) edges_.push_back({before[i].point.face, after[k].point.face});
      }
    }
  }

  const PreparedFlow& flow_;
  const TriangleMesh& mesh_;
  double tau_;
  std::unique_ptr<PointAdvector> forward_, backward_;
  std::vector<TangencyEdge> edges_;
};

}  // namespace

std::vector<TangencyEdge> boundaryTangencyEdges(const PreparedFlow& flow, double tau, const Progress* progress) {
  return TangencyTracer(flow, tau, progress).run();
}

}  // namespace stormfield
