#include "streamlines/detail/coverage.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "streamlines/detail/face_velocity.h"

namespace stormfield {

/// A triangle inside a face, by the barycentric coordinates of its corners.
struct Coverage::Corners {
  std::array<Eigen::Vector3d, 3> b;
};

Coverage::Coverage(const FlatFaces& faces, const VectorField& field, double reach, double resolution, double minSpeed)
    : faces_(faces),
      field_(field),
      reach_(reach),
      resolution_(resolution),
      minSpeed_(minSpeed),
      patch_(faces.mesh()),
      distance_(static_cast<std::size_t>(faces.mesh().vertexCount()), std::numeric_limits<double>::infinity()),
      open_(static_cast<std::size_t>(faces.mesh().faceCount())) {
  std::iota(open_.begin(), open_.end(), Index{0});
}

void Coverage::add(const LineSample& sample) {
  const TriangleMesh& mesh = faces_.mesh();
  patch_.gather(sample.face, sample.position, reach_);
  for (const Index f : patch_.faces()) {
    const Vec3 normal = mesh.faceNormal(f);
    for (int k = 0; k < 3; ++k) {
      const Index v = mesh.vertex(f, k);
      const double squared = squaredSurfaceDistance(sample.position, sample.normal, mesh.point(v), normal);
      if (squared > reach_ * reach_) continue;
      if (distance_[v] == std::numeric_limits<double>::infinity()) ++reached_;
      distance_[v] = std::min(distance_[v], std::sqrt(squared));
    }
  }
}

double Coverage::bound(Index face, const Vec3& p) const {
  const TriangleMesh& mesh = faces_.mesh();
  double bound = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Index v = mesh.vertex(face, k);
    bound = std::min(bound, distance_[v] + (mesh.point(v) - p).norm());
  }
  return bound;
}

std::vector<Gap> Coverage::findGaps(const NearLines& lines, Progress* progress) {
  std::vector<std::vector<Gap>> found(open_.size());
  tbb::enumerable_thread_specific<SurfacePatch> patches([&] { return SurfacePatch(faces_.mesh()); });
  const Corners whole{{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}};
  tbb::parallel_for(std::size_t{0}, open_.size(), [&](std::size_t i) {
    if (progress != nullptr) progress->check();
    search(lines, open_[i], whole, patches.local(), found[i]);
  });
  std::vector<Gap> gaps;
  std::vector<Index> open;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].empty()) continue;
    open.push_back(open_[i]);
    gaps.insert(gaps.end(), found[i].begin(), found[i].end());
  }
  open_ = std::move(open);
  std::stable_sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.distance > b.distance; });
  return gaps;
}

void Coverage::search(const NearLines& lines, Index face, const Corners& corners, SurfacePatch& patch,
                      std::vector<Gap>& gaps) const {
  const TriangleMesh& mesh = faces_.mesh();
  const auto& b = corners.b;
  const SurfacePoint middle{face, (b[0] + b[1] + b[2]) / 3.0};
  const Vec3 p = position(mesh, middle);
  double radius = 0.0;
  for (const Eigen::Vector3d& corner : b) radius = std::max(radius, (position(mesh, {face, corner}) - p).norm());
  const double covered = reach_ + resolution_;
  if (bound(face, p) + radius <= covered) return;
  const auto found = lines.nearest(p, face, covered, patch, [](const LineSample&) { return true; });
  const double distance = found ? found->distance : std::numeric_limits<double>::infinity();
  if (distance + radius <= covered) return;
  if (radius > resolution_) {  // neither covered nor small
    const std::array<Eigen::Vector3d, 3> m = {0.5 * (b[1] + b[2]), 0.5 * (b[2] + b[0]), 0.5 * (b[0] + b[1])};
    for (const Corners& piece : {Corners{{b[0], m[2], m[1]}}, Corners{{m[2], b[1], m[0]}}, Corners{{m[1], m[0], b[2]}},
                                 Corners{{m[0], m[1], m[2]}}}) {
      search(lines, face, piece, patch, gaps);
    }
    return;
  }
  // The middle stands for the piece.
  if (distance <= reach_ || std::abs(velocityAt(faces_, field_, middle)) <= minSpeed_) return;
  gaps.push_back({middle, distance});
}

}  // namespace stormfield
