// Closest points on the surface, through Eigen's bounding volume hierarchy.
//
// Throws InputError on query points that are not finite. Among equally close points one is chosen, always the same.
#pragma once

#include <memory>
#include <vector>

#include "mesh/surface_point.h"

namespace stormfield {

struct ClosestPoint {
  SurfacePoint point;
  double distance = 0.0;  ///< mesh units
};

class ClosestPointQuery {
 public:
  explicit ClosestPointQuery(std::shared_ptr<const TriangleMesh> mesh);
  ~ClosestPointQuery();
  ClosestPointQuery(ClosestPointQuery&&) noexcept;

  ClosestPoint closest(const Vec3& p) const;
  /// The same answer, sooner where `nearby` is the closest point of a place not far from p.
  ClosestPoint closest(const Vec3& p, const SurfacePoint& nearby) const;
  /// One result per row, in parallel.
  std::vector<ClosestPoint> closest(const Points& points) const;

 private:
  ClosestPoint search(const Vec3& p, double bound) const;

  struct Tree;
  std::shared_ptr<const TriangleMesh> mesh_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace stormfield
