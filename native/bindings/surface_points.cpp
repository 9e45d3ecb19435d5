#include "bindings/surface_points.h"

#include <tbb/parallel_for.h>

namespace stormfield::bindings {

py::array_t<double> positionsOf(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
  Points result(static_cast<Eigen::Index>(points.size()), 3);
  tbb::parallel_for(std::size_t{0}, points.size(),
                    [&](std::size_t i) { result.row(static_cast<Eigen::Index>(i)) = position(mesh, points[i]); });
  return fromPoints(result);
}

py::array_t<Index> facesOf(const std::vector<SurfacePoint>& points) {
  py::array_t<Index> result(static_cast<py::ssize_t>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) result.mutable_at(static_cast<py::ssize_t>(i)) = points[i].face;
  return result;
}

py::array_t<double> barycentricOf(const std::vector<SurfacePoint>& points) {
  Points result(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) result.row(static_cast<Eigen::Index>(i)) = points[i].barycentric;
  return fromPoints(result);
}

}  // namespace stormfield::bindings
