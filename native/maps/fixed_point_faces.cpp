#include "maps/fixed_point_faces.h"

#include <tbb/parallel_for.h>

#include "field/poincare_index.h"
#include "maps/geometry_map.h"

namespace stormfield {

std::vector<char> fixedPointFaces(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  const std::vector<int> indices = poincareIndices(field);
  std::vector<char> holds(mesh.faceCount());
  tbb::parallel_for(Index{0}, mesh.faceCount(), [&](Index f) {
    bool found = indices[f] != 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      // Along the same halfedge for both faces, so that round-off gives both the same answer.
      found = found || holdsFixedPointOnEdge(endVectors(field, mesh.edgeHalfedge(mesh.edge(h))));
    }
    holds[f] = found ? 1 : 0;
  });
  return holds;
}

}  // namespace stormfield
