// A drawn curve on the surface: the artist's points projected to their closest points and joined along the surface.
//
// Between two drawn points the straight line is cut to half the mean edge length and projected as well, so that sparse
// and dense drawings of one curve give one path. Lambda grows with arc length between the points that carry a value.
#pragma once

#include <string>
#include <vector>

#include "design/element.h"
#include "mesh/closest_point.h"

namespace stormfield {

class SurfacePath {
 public:
  /// Throws InputError naming the curve and the point when a drawn point lies off the surface, farther than the
  /// element's radius, or when a curve shrinks to one point on the surface.
  SurfacePath(const TriangleMesh& mesh, const ClosestPointQuery& query, const DesignElement& element);

  double length() const { return arc_.back(); }
  double start() const { return lambda_.front(); }
  double end() const { return lambda_.back(); }
  bool moves() const { return moves_; }
  /// The last fine sample is the first again.
  bool closed() const { return closed_; }

  /// The fine samples: points on the surface, their positions and arc lengths.
  const std::vector<SurfacePoint>& points() const { return points_; }
  const std::vector<Vec3>& positions() const { return positions_; }
  const std::vector<double>& arc() const { return arc_; }

  /// Where the path is at lambda (its ends outside of start..end; its first point when it does not move).
  SurfacePoint at(double lambda) const;
  /// The same in space, on the fine polyline.
  Vec3 positionAt(double lambda) const;

 private:
  const ClosestPointQuery* query_;
  std::vector<SurfacePoint> points_;
  std::vector<Vec3> positions_;
  std::vector<double> arc_;
  std::vector<double> lambda_;  ///< one per fine sample when the path moves, otherwise start and end
  bool moves_ = false, closed_ = false;
};

}  // namespace stormfield
