#include "mesh/triangle_mesh.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "mesh/detail/connectivity.h"

namespace stormfield {

TriangleMesh::TriangleMesh(Points points, Triangles triangles)
    : points_(std::move(points)), triangles_(std::move(triangles)) {
  checkTriangles(points_, triangles_);
  twin_ = pairHalfedges(vertexCount(), triangles_);
  const Orientation orientation = orientFaces(triangles_, twin_);
  flippedFaceCount_ = orientation.flippedFaceCount;
  outgoing_ = firstOutgoing(vertexCount(), triangles_, twin_);
  numberEdges();
  findComponents(orientation.faceComponent);
  measure();
}

void TriangleMesh::numberEdges() {
  edge_.assign(halfedgeCount(), kNone);
  edgeHalfedge_.reserve(static_cast<std::size_t>(halfedgeCount()) / 2 + 1);
  for (Index h = 0; h < halfedgeCount(); ++h) {
    if (edge_[h] != kNone) continue;
    edge_[h] = edgeCount();
    if (twin_[h] != kNone) edge_[twin_[h]] = edgeCount();
    edgeHalfedge_.push_back(h);
  }
}

void TriangleMesh::findComponents(const std::vector<Index>& faceComponent) {
  std::vector<Index> number(faceComponent.size(), kNone);
  component_.assign(vertexCount(), kNone);
  boundaryVertex_.assign(vertexCount(), 0);
  Index used = 0;
  for (Index v = 0; v < vertexCount(); ++v) {
    if (outgoing_[v] == kNone) continue;
    ++used;
    boundaryVertex_[v] = twin_[outgoing_[v]] == kNone;
    Index& c = number[faceComponent[face(outgoing_[v])]];
    if (c == kNone) c = componentCount_++;
    component_[v] = c;
  }
  eulerCharacteristic_ = used - edgeCount() + faceCount();

  std::vector<char> seen(halfedgeCount(), 0);
  for (Index seed = 0; seed < halfedgeCount(); ++seed) {
    if (twin_[seed] != kNone || seen[seed]) continue;
    ++boundaryLoopCount_;
    // The first outgoing halfedge of a boundary vertex is the one that continues its loop.
    for (Index h = seed; !seen[h]; h = outgoing_[head(h)]) seen[h] = 1;
  }
}

void TriangleMesh::measure() {
  edgeLength_.resize(edgeCount());
  faceArea_.resize(faceCount());
  cornerAngle_.resize(halfedgeCount());
  tbb::parallel_for(Index{0}, edgeCount(), [&](Index e) {
    edgeLength_[e] = (point(head(edgeHalfedge_[e])) - point(tail(edgeHalfedge_[e]))).norm();
  });
  tbb::parallel_for(Index{0}, faceCount(), [&](Index f) {
    const Vec3 side[3] = {point(vertex(f, 1)) - point(vertex(f, 0)), point(vertex(f, 2)) - point(vertex(f, 1)),
                          point(vertex(f, 0)) - point(vertex(f, 2))};
    const double doubleArea = side[0].cross(side[1]).norm();
    faceArea_[f] = 0.5 * doubleArea;
    for (int k = 0; k < 3; ++k) cornerAngle_[halfedge(f, k)] = std::atan2(doubleArea, -side[k].dot(side[(k + 2) % 3]));
  });
  vertexArea_.assign(vertexCount(), 0.0);
  for (Index h = 0; h < halfedgeCount(); ++h) vertexArea_[tail(h)] += faceArea_[face(h)] / 3.0;
  totalArea_ = std::accumulate(faceArea_.begin(), faceArea_.end(), 0.0);
  meanEdgeLength_ = std::accumulate(edgeLength_.begin(), edgeLength_.end(), 0.0) / edgeCount();
}

Vec3 TriangleMesh::faceNormal(Index f) const {
  const Vec3 origin = point(vertex(f, 0));
  return (point(vertex(f, 1)) - origin).cross(point(vertex(f, 2)) - origin).normalized();
}

double TriangleMesh::size() const {
  return std::sqrt(totalArea_);
}

}  // namespace stormfield
