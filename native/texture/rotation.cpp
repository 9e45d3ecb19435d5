#include "texture/rotation.h"

#include <algorithm>

namespace stormfield {

void rotation(const TriangleMesh& mesh, const Points& vectors, double* result) {
  std::fill_n(result, mesh.vertexCount(), 0.0);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    double circulation = 0.0;
    for (int i = 0; i < 3; ++i) {
      // Each corner's vector counts in both edges that end there: together half of the edge opposite to it.
      const Vec3 opposite = mesh.point(mesh.vertex(f, (i + 1) % 3)) - mesh.point(mesh.vertex(f, (i + 2) % 3));
      circulation += 0.5 * opposite.dot(vectors.row(mesh.vertex(f, i)).transpose());
    }
    for (int i = 0; i < 3; ++i) result[mesh.vertex(f, i)] += circulation;
  }
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (mesh.vertexArea(v) > 0.0) result[v] /= 3.0 * mesh.vertexArea(v);
  }
}

}  // namespace stormfield
