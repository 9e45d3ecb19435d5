#include "io/detail/inside.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace stormfield {
namespace {

Vec3 corner(const TriangleMesh& mesh, Index f, int k) {
  return mesh.point(mesh.vertex(f, k));
}

/// The normal at a surface point, not normalised: of the face, of both faces of an edge, or of all faces around a
/// vertex weighted by their angles. Its sign against the way to a point that has this as its closest one is right
/// everywhere (Baerentzen and Aanaes 2005).
Vec3 pseudonormal(const TriangleMesh& mesh, const SurfacePoint& p) {
  int zeros = 0, zero = 0, other = 0;
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] == 0.0) {
      ++zeros;
      zero = k;
    } else {
      other = k;
    }
  }
  if (zeros == 0) return mesh.faceNormal(p.face);
  if (zeros == 1) {
    const Index h = TriangleMesh::halfedge(p.face, (zero + 1) % 3);  // opposite of the corner
    return mesh.faceNormal(p.face) + mesh.faceNormal(TriangleMesh::face(mesh.twin(h)));
  }
  Vec3 sum = Vec3::Zero();
  for (Index h = mesh.outgoing(mesh.vertex(p.face, other)); h != kNone; h = mesh.nextOutgoing(h)) {
    sum += mesh.cornerAngle(h) * mesh.faceNormal(TriangleMesh::face(h));
  }
  return sum;
}

/// Solid angle of a triangle seen from p (Van Oosterom and Strackee 1983).
double solidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

EnclosedSpace::EnclosedSpace(const TriangleMesh& mesh) : mesh_(mesh), components_(mesh.componentCount()) {
  struct Extent {
    Eigen::AlignedBox3d box;
    std::vector<Index> faces;
    double volume = 0.0;
  };
  std::vector<Extent> extents(mesh.componentCount());
  const Vec3 middle = mesh.points().colwise().mean();
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    Extent& extent = extents[mesh.component(mesh.vertex(f, 0))];
    extent.faces.push_back(f);
    for (int k = 0; k < 3; ++k) extent.box.extend(corner(mesh, f, k));
    extent.volume +=
        (corner(mesh, f, 0) - middle).dot((corner(mesh, f, 1) - middle).cross(corner(mesh, f, 2) - middle));
  }
  for (Index c = 0; c < mesh.componentCount(); ++c) {
    components_[c].normalsPointOut = extents[c].volume > 0.0;
    const Vec3 p = corner(mesh, extents[c].faces.front(), 0);
    for (Index around = 0; around < mesh.componentCount() && !components_[c].enclosed; ++around) {
      if (around == c || !extents[around].box.contains(p)) continue;
      double angle = 0.0;
      for (const Index f : extents[around].faces) {
        angle += solidAngle(corner(mesh, f, 0) - p, corner(mesh, f, 1) - p, corner(mesh, f, 2) - p);
      }
      components_[c].enclosed = std::abs(angle) > 2.0 * std::numbers::pi;  // 4 pi inside, 0 outside
    }
  }
}

bool EnclosedSpace::contains(const Vec3& p, const SurfacePoint& closest) const {
  const Component& component = components_[mesh_.component(mesh_.vertex(closest.face, 0))];
  if (component.enclosed) return true;
  const bool alongNormals = (p - position(mesh_, closest)).dot(pseudonormal(mesh_, closest)) >= 0.0;
  return alongNormals != component.normalsPointOut;
}

}  // namespace stormfield
