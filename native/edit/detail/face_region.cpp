#include "edit/detail/face_region.h"

#include <algorithm>

namespace stormfield {

void FaceRegion::add(Index face) {
  if (inside_[face] != 0) return;
  inside_[face] = 1;
  faces_.push_back(face);
}

std::vector<Index> FaceRegion::sortedFaces() const {
  std::vector<Index> sorted = faces_;
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

std::vector<Index> FaceRegion::innerVertices() const {
  std::vector<Index> vertices;
  for (const Index f : faces_) {
    for (int k = 0; k < 3; ++k) vertices.push_back(mesh_->vertex(f, k));
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::erase_if(vertices, [&](Index v) {
    if (mesh_->isBoundaryVertex(v)) return true;
    for (Index h = mesh_->outgoing(v); h != kNone; h = mesh_->nextOutgoing(h)) {
      if (!holds(TriangleMesh::face(h))) return true;
    }
    return false;
  });
  return vertices;
}

std::vector<Index> facesAround(const TriangleMesh& mesh, Index vertex) {
  std::vector<Index> faces;
  for (Index h = mesh.outgoing(vertex); h != kNone; h = mesh.nextOutgoing(h)) faces.push_back(TriangleMesh::face(h));
  return faces;
}

std::vector<Index> facesAt(const TriangleMesh& mesh, const SurfacePoint& point) {
  std::vector<Index> faces{point.face};
  for (int k = 0; k < 3; ++k) {
    const double opposite = point.barycentric[(k + 2) % 3];
    if (point.barycentric[k] == 1.0) return facesAround(mesh, mesh.vertex(point.face, k));
    const Index twin = mesh.twin(TriangleMesh::halfedge(point.face, k));
    if (opposite == 0.0 && twin != kNone) faces.push_back(TriangleMesh::face(twin));
  }
  return faces;
}

std::vector<Index> connected(const FaceRegion& region, Index first, std::vector<char>& seen) {
  const TriangleMesh& mesh = region.mesh();
  std::vector<Index> result{first};
  seen[first] = 1;
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (Index h = 3 * result[i]; h < 3 * result[i] + 3; ++h) {
      const Index twin = mesh.twin(h);
      if (twin == kNone) continue;
      const Index f = TriangleMesh::face(twin);
      if (seen[f] != 0 || region.holds(f) != region.holds(first)) continue;
      seen[f] = 1;
      result.push_back(f);
    }
  }
  return result;
}

}  // namespace stormfield
