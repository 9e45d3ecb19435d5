#include "mesh/surface_point.h"

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

Vec3 position(const TriangleMesh& mesh, const SurfacePoint& p) {
  return p.barycentric[0] * mesh.point(mesh.vertex(p.face, 0)) + p.barycentric[1] * mesh.point(mesh.vertex(p.face, 1)) +
         p.barycentric[2] * mesh.point(mesh.vertex(p.face, 2));
}

Index nearestVertex(const TriangleMesh& mesh, const SurfacePoint& p) {
  int corner = 0;
  p.barycentric.maxCoeff(&corner);
  return mesh.vertex(p.face, corner);
}

SurfacePoint vertexPoint(const TriangleMesh& mesh, Index v) {
  if (v < 0 || v >= mesh.vertexCount() || mesh.outgoing(v) == kNone) {
    throw InputError(message("vertex ", v, " is not on the surface; choose a vertex that a face uses"));
  }
  SurfacePoint p;
  p.face = TriangleMesh::face(mesh.outgoing(v));
  p.barycentric[TriangleMesh::corner(mesh.outgoing(v))] = 1.0;
  return p;
}

}  // namespace stormfield
