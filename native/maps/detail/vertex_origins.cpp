#include "maps/detail/vertex_origins.h"

#include <algorithm>

namespace stormfield {
namespace {

void traceBack(RowTask& task, const std::vector<Index>& vertices, std::vector<VertexOrigin>& origins) {
  task.advectStepwise(
      vertices.size(), Direction::Backward, [&](std::size_t i) { return vertexPoint(task.mesh, vertices[i]); },
      [&](std::size_t i, int step, const AdvectedPoint& at) {
        const bool isLast = step == task.steps;
        const bool isInside = !at.leftSurface && (isLast || task.isInWindow(task.steps - step, at));
        origins[vertices[i]] = isInside ? VertexOrigin(at.point.face) : VertexOrigin::none();
        return isInside && !isLast;
      });
}

}  // namespace

std::vector<VertexOrigin> vertexOrigins(RowTask& task, const ForwardImages& images,
                                        const std::vector<TangencyEdge>& tangencies) {
  const TriangleMesh& mesh = task.mesh;
  std::vector<VertexOrigin> origins(mesh.vertexCount());
  task.budget.take(sizeof(VertexOrigin) * origins.size());
  std::vector<Index> requested, next;
  const auto request = [&](std::vector<Index>& list, Index v) {
    if (origins[v].isRequested()) return;
    origins[v] = VertexOrigin::pending();
    list.push_back(v);
  };
  const auto requestFace = [&](Index f) {
    for (int k = 0; k < 3; ++k) request(requested, mesh.vertex(f, k));
  };
  for (std::size_t i = 0; i < task.edges.elements().size(); ++i) {
    for (const Index f : images.faces.list(i)) requestFace(f);
  }
  for (const TangencyEdge& edge : tangencies) requestFace(edge.image);
  for (const Index v : task.vertices.elements()) request(requested, v);
  while (!requested.empty()) {
    std::sort(requested.begin(), requested.end());
    traceBack(task, requested, origins);
    next.clear();
    for (const Index v : requested) {
      if (!origins[v].isFace() || !std::binary_search(task.faces.begin(), task.faces.end(), origins[v].face()))
        continue;
      for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
        request(next, mesh.head(h));
        request(next, mesh.tail(TriangleMesh::prev(h)));
      }
    }
    requested.swap(next);
  }
  return origins;
}

}  // namespace stormfield
