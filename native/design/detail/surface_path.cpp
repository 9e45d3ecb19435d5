#include "design/detail/surface_path.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace stormfield {

namespace {

constexpr std::size_t kMaxPiecesPerSegment = 4096;

void checkOnSurface(const DesignElement& element, std::size_t i, double distance) {
  if (distance <= element.radius.largest()) return;
  throw InputError(describe(element) + " point " + std::to_string(i) + " lies " + shortNumber(distance) +
                   " off the surface, farther than its radius " + shortNumber(element.radius.largest()) +
                   ": move it onto the surface or enlarge the radius");
}

/// Lambda of the drawn points: given, or spread by arc length between start and end.
std::vector<double> drawnLambdas(const DesignElement& element, const std::vector<double>& arcAtDrawn) {
  const std::vector<double>& given = element.lambdas;
  if (given.size() == arcAtDrawn.size()) return given;
  std::vector<double> lambdas;
  const double length = arcAtDrawn.back();
  for (const double arc : arcAtDrawn)
    lambdas.push_back(given.front() + (given.back() - given.front()) * (length > 0.0 ? arc / length : 0.0));
  return lambdas;
}

}  // namespace

SurfacePath::SurfacePath(const TriangleMesh& mesh, const ClosestPointQuery& query, const DesignElement& element)
    : query_(&query) {
  // The second point of a regular element is the tip of its arrow, not a place.
  const std::size_t places = element.type == ElementType::Regular ? 1 : element.points.size();
  closed_ = element.type == ElementType::Orbit;
  const std::size_t stops = closed_ && element.points.front() != element.points.back() ? places + 1 : places;
  std::vector<std::size_t> drawnAt;
  for (std::size_t i = 0; i < stops; ++i) {
    const ClosestPoint drawn = query.closest(element.points[i % places]);
    checkOnSurface(element, i % places, drawn.distance);
    const Vec3 target = position(mesh, drawn.point);
    if (i > 0) {
      const Vec3 from = positions_.back();
      const double pieces = std::ceil((target - from).norm() / (0.5 * mesh.meanEdgeLength()));
      const std::size_t count = std::min(kMaxPiecesPerSegment, static_cast<std::size_t>(pieces));
      for (std::size_t k = 1; k < count; ++k) {
        const double fraction = static_cast<double>(k) / static_cast<double>(count);
        points_.push_back(query.closest(Vec3(from + fraction * (target - from))).point);
        positions_.push_back(position(mesh, points_.back()));
      }
    }
    points_.push_back(drawn.point);
    positions_.push_back(target);
    drawnAt.push_back(points_.size() - 1);
  }
  arc_.assign(points_.size(), 0.0);
  for (std::size_t k = 1; k < points_.size(); ++k) arc_[k] = arc_[k - 1] + (positions_[k] - positions_[k - 1]).norm();
  if (isCurve(element) && !(length() > 0.0))
    throw InputError(describe(element) + " shrinks to one point on the surface: draw it longer");

  moves_ = stormfield::moves(element);
  if (!moves_) {
    lambda_ = {element.lambdas.front(), element.lambdas.back()};
    return;
  }
  std::vector<double> arcAtDrawn;
  for (const std::size_t k : drawnAt) arcAtDrawn.push_back(arc_[k]);
  const std::vector<double> drawn = drawnLambdas(element, arcAtDrawn);
  lambda_.assign(points_.size(), drawn.front());
  for (std::size_t i = 1; i < drawn.size(); ++i) {
    const std::size_t a = drawnAt[i - 1], b = drawnAt[i];
    const double span = arc_[b] - arc_[a];
    for (std::size_t k = a + 1; k <= b; ++k) {
      const double fraction = span > 0.0 ? (arc_[k] - arc_[a]) / span : 1.0;
      lambda_[k] = drawn[i - 1] + fraction * (drawn[i] - drawn[i - 1]);
    }
  }
}

Vec3 SurfacePath::positionAt(double lambda) const {
  if (!moves_ || lambda <= start()) return positions_.front();
  if (lambda >= end()) return positions_.back();
  const std::size_t k =
      static_cast<std::size_t>(std::upper_bound(lambda_.begin(), lambda_.end(), lambda) - lambda_.begin());
  const double span = lambda_[k] - lambda_[k - 1];
  const double fraction = span > 0.0 ? (lambda - lambda_[k - 1]) / span : 0.0;
  return positions_[k - 1] + fraction * (positions_[k] - positions_[k - 1]);
}

SurfacePoint SurfacePath::at(double lambda) const {
  if (!moves_ || lambda <= start()) return points_.front();
  if (lambda >= end()) return points_.back();
  return query_->closest(positionAt(lambda)).point;
}

}  // namespace stormfield
