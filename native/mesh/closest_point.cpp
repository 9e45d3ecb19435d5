#include "mesh/closest_point.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <queue>
#include <unsupported/Eigen/BVH>
#include <utility>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {
namespace {

using Bvh = Eigen::KdBVH<double, 3, Index>;
using Box = Bvh::Volume;

struct OnTriangle {
  Eigen::Vector3d barycentric;
  double squaredDistance;
};

OnTriangle closestOnSide(const Vec3& p, const std::array<Vec3, 3>& corners, int side) {
  const int i = side, j = (side + 1) % 3;
  const Vec3 along = corners[j] - corners[i];
  const double t = std::clamp((p - corners[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
  OnTriangle result{Eigen::Vector3d::Zero(), (p - corners[i] - t * along).squaredNorm()};
  result.barycentric[i] = 1.0 - t;
  result.barycentric[j] = t;
  return result;
}

/// The foot of the perpendicular when it lies inside, otherwise the best point of the three sides.
OnTriangle closestOnTriangle(const Vec3& p, const std::array<Vec3, 3>& corners) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double squaredNormal = normal.squaredNorm();
  Eigen::Vector3d b;
  for (int k = 0; k < 3; ++k) {
    const Vec3& from = corners[(k + 1) % 3];
    b[k] = (corners[(k + 2) % 3] - from).cross(p - from).dot(normal) / squaredNormal;
  }
  if (b.minCoeff() >= 0.0) {
    b /= b.sum();
    const Vec3 foot = b[0] * corners[0] + b[1] * corners[1] + b[2] * corners[2];
    return {b, (p - foot).squaredNorm()};
  }
  OnTriangle best = closestOnSide(p, corners, 0);
  for (int side = 1; side < 3; ++side) {
    const OnTriangle candidate = closestOnSide(p, corners, side);
    if (candidate.squaredDistance < best.squaredDistance) best = candidate;
  }
  return best;
}

std::array<Vec3, 3> corners(const TriangleMesh& mesh, Index f) {
  return {mesh.point(mesh.vertex(f, 0)), mesh.point(mesh.vertex(f, 1)), mesh.point(mesh.vertex(f, 2))};
}

/// The closest of the faces visited so far; the first among equals.
struct Minimizer {
  const TriangleMesh& mesh;
  const Vec3& p;
  SurfacePoint best = {};
  double bestSquared = std::numeric_limits<double>::infinity();

  void visit(Index f) {
    const OnTriangle candidate = closestOnTriangle(p, corners(mesh, f));
    if (candidate.squaredDistance < bestSquared) {
      bestSquared = candidate.squaredDistance;
      best = {f, candidate.barycentric};
    }
  }
};

/// Visits the faces of the boxes in the order of their distance (as Eigen::BVMinimize, which however goes on through
/// boxes that are farther than the best face). Some point is known to be within `bound` (squared). `rounding` is the
/// error of distances: boxes that much farther than bound or best are looked into, so that the answer does not depend
/// on when the search could have stopped.
void minimize(const Bvh& bvh, double bound, double rounding, Minimizer& minimizer) {
  const auto widened = [&](double squared) {
    const double distance = std::sqrt(squared) + rounding;
    return distance * distance;
  };
  using Entry = std::pair<double, Bvh::Index>;
  std::vector<Entry> storage;
  storage.reserve(64);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> todo({}, std::move(storage));
  todo.emplace(0.0, bvh.getRootIndex());
  double limit = widened(bound);
  while (!todo.empty() && todo.top().first <= limit) {
    Bvh::VolumeIterator box = nullptr, boxEnd = nullptr;
    Bvh::ObjectIterator face = nullptr, faceEnd = nullptr;
    bvh.getChildren(todo.top().second, box, boxEnd, face, faceEnd);
    todo.pop();
    if (face != faceEnd) {
      for (; face != faceEnd; ++face) minimizer.visit(*face);
      limit = std::min(limit, widened(minimizer.bestSquared));
    }
    for (; box != boxEnd; ++box) {
      const double distance = bvh.getVolume(*box).squaredExteriorDistance(minimizer.p);
      if (distance <= limit && distance < minimizer.bestSquared) todo.emplace(distance, *box);
    }
  }
}

}  // namespace

struct ClosestPointQuery::Tree {
  Bvh bvh;
  double reach = 0.0;  ///< largest coordinate
};

ClosestPointQuery::ClosestPointQuery(std::shared_ptr<const TriangleMesh> mesh)
    : mesh_(std::move(mesh)), tree_(std::make_unique<Tree>()) {
  std::vector<Index> faces(mesh_->faceCount());
  std::vector<Box> boxes(mesh_->faceCount());
  for (Index f = 0; f < mesh_->faceCount(); ++f) {
    faces[f] = f;
    for (const Vec3& corner : corners(*mesh_, f)) boxes[f].extend(corner);
  }
  tree_->bvh.init(faces.begin(), faces.end(), boxes.begin(), boxes.end());
  tree_->reach = mesh_->points().cwiseAbs().maxCoeff();
}

ClosestPointQuery::~ClosestPointQuery() = default;
ClosestPointQuery::ClosestPointQuery(ClosestPointQuery&&) noexcept = default;

ClosestPoint ClosestPointQuery::closest(const Vec3& p) const {
  return search(p, std::numeric_limits<double>::infinity());
}

ClosestPoint ClosestPointQuery::closest(const Vec3& p, const SurfacePoint& nearby) const {
  return search(p, closestOnTriangle(p, corners(*mesh_, nearby.face)).squaredDistance);
}

ClosestPoint ClosestPointQuery::search(const Vec3& p, double bound) const {
  if (!p.allFinite()) throw InputError("a query point has a coordinate that is not finite; give it a real position");
  Minimizer minimizer{*mesh_, p};
  // A tree of one object has no node to start from.
  if (mesh_->faceCount() == 1)
    minimizer.visit(0);
  else
    minimize(tree_->bvh, bound, 1e-12 * (tree_->reach + p.cwiseAbs().maxCoeff()), minimizer);
  return {minimizer.best, std::sqrt(minimizer.bestSquared)};
}

std::vector<ClosestPoint> ClosestPointQuery::closest(const Points& points) const {
  for (Index i = 0; i < points.rows(); ++i) {
    if (!points.row(i).allFinite()) {
      throw InputError(message("query point ", i, " has a coordinate that is not finite; give it a real position"));
    }
  }
  std::vector<ClosestPoint> result(points.rows());
  tbb::parallel_for(Index{0}, static_cast<Index>(points.rows()),
                    [&](Index i) { result[i] = closest(Vec3(points.row(i))); });
  return result;
}

}  // namespace stormfield
