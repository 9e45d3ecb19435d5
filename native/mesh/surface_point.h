// A location on the surface: the one type that all queries, tracers and design elements use.
#pragma once

#include "mesh/triangle_mesh.h"

namespace stormfield {

/// Face and barycentric coordinates (>= 0, sum 1) of its corners. Points on edges and vertices have zeros there.
struct SurfacePoint {
  Index face = kNone;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
};

/// Position in mesh units.
Vec3 position(const TriangleMesh& mesh, const SurfacePoint& p);
/// The corner of face p.face with the largest coordinate: the nearest vertex in barycentric sense.
Index nearestVertex(const TriangleMesh& mesh, const SurfacePoint& p);
SurfacePoint vertexPoint(const TriangleMesh& mesh, Index v);

}  // namespace stormfield
