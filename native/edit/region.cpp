#include "edit/region.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "edit/detail/face_region.h"
#include "mesh/closest_point.h"

namespace stormfield {
namespace {

/// The faces of the curve, in steps that leave out none by more than a corner.
FaceRegion facesOfCurve(const TriangleMesh& mesh, const ClosestPointQuery& query, const std::vector<Vec3>& points) {
  FaceRegion curve(mesh);
  const double step = 0.1 * mesh.meanEdgeLength();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 &from = points[i], &to = points[(i + 1) % points.size()];
    const int count = 1 + static_cast<int>((to - from).norm() / step);
    for (int k = 0; k < count; ++k) {
      const Vec3 p = from + (static_cast<double>(k) / count) * (to - from);
      for (const Index f : facesAt(mesh, query.closest(p).point)) curve.add(f);
    }
  }
  return curve;
}

}  // namespace

std::vector<Index> facesInDisc(const TriangleMesh& mesh, const SurfacePoint& center, double radius) {
  const Vec3 middle = position(mesh, center);
  const auto isInside = [&](Index f) {
    for (int k = 0; k < 3; ++k) {
      if ((mesh.point(mesh.vertex(f, k)) - middle).norm() > radius) return false;
    }
    return true;
  };
  FaceRegion region(mesh);
  if (isInside(center.face)) region.add(center.face);
  for (std::size_t i = 0; i < region.faces().size(); ++i) {
    for (Index h = 3 * region.faces()[i], last = h + 3; h < last; ++h) {
      if (mesh.twin(h) != kNone && isInside(TriangleMesh::face(mesh.twin(h)))) {
        region.add(TriangleMesh::face(mesh.twin(h)));
      }
    }
  }
  return region.sortedFaces();
}

std::vector<Index> facesInLoop(const TriangleMesh& mesh, const ClosestPointQuery& query,
                               const std::vector<Vec3>& points) {
  if (points.size() < 3) throw InputError("a loop needs three points or more; draw a closed curve around the region");
  FaceRegion region = facesOfCurve(mesh, query, points);
  const Index component = mesh.component(mesh.vertex(region.faces().front(), 0));
  std::vector<char> seen(mesh.faceCount(), 0);
  std::vector<std::vector<Index>> parts;
  std::vector<double> areas;
  for (Index first = 0; first < mesh.faceCount(); ++first) {
    if (seen[first] != 0 || region.holds(first) || mesh.component(mesh.vertex(first, 0)) != component) continue;
    parts.push_back(connected(region, first, seen));
    areas.push_back(0.0);
    for (const Index f : parts.back()) areas.back() += mesh.faceArea(f);
  }
  const auto largest = std::max_element(areas.begin(), areas.end());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (static_cast<std::ptrdiff_t>(i) == largest - areas.begin()) continue;
    for (const Index f : parts[i]) region.add(f);
  }
  return region.sortedFaces();
}

}  // namespace stormfield
