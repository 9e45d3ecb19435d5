// A growing set of faces of a mesh.
#pragma once

#include <vector>

#include "mesh/surface_point.h"

namespace stormfield {

class FaceRegion {
 public:
  explicit FaceRegion(const TriangleMesh& mesh) : mesh_(&mesh), inside_(mesh.faceCount(), 0) {}

  const TriangleMesh& mesh() const { return *mesh_; }
  bool holds(Index face) const { return inside_[face] != 0; }
  void add(Index face);
  /// Not sorted.
  const std::vector<Index>& faces() const { return faces_; }
  std::vector<Index> sortedFaces() const;
  /// Vertices all of whose faces are inside, away from the boundary of the surface: what may change when everything
  /// outside stays. Ascending.
  std::vector<Index> innerVertices() const;

 private:
  const TriangleMesh* mesh_;
  std::vector<char> inside_;
  std::vector<Index> faces_;
};

/// All faces around a vertex.
std::vector<Index> facesAround(const TriangleMesh& mesh, Index vertex);
/// The faces that a point touches: one, two on an edge, all around a vertex.
std::vector<Index> facesAt(const TriangleMesh& mesh, const SurfacePoint& point);

/// The faces that hang together with the first by edges, inside or outside of the region as that one is. seen: per face,
/// marked.
std::vector<Index> connected(const FaceRegion& region, Index first, std::vector<char>& seen);

}  // namespace stormfield
