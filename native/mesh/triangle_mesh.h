// An immutable, oriented triangle 2-manifold: with or without boundary, several components, any genus.
//
// Halfedge h = 3 f + k runs along face f from its corner k to its corner (k + 1) mod 3, with the face on its left,
// so that the connectivity needs no other table than the twins. Vertices that no face uses are kept (vertex order is
// the caller's and never changes) but belong to no component.
//
//   const TriangleMesh mesh(points, triangles);  // throws MeshError
//   std::vector<Index> neighbours;
//   for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) neighbours.push_back(mesh.head(h));
#pragma once

#include <vector>

#include "base/types.h"

namespace stormfield {

class TriangleMesh {
 public:
  /// Checks and connects. Faces of a component whose orientations disagree are flipped to agree with the majority
  /// (see flippedFaceCount). Throws MeshError naming the element and the cure on: a bad index, a coordinate that is not
  /// finite, no faces, a face without area, a face given twice, an edge with three faces, a vertex with two fans, a
  /// surface that cannot be oriented.
  TriangleMesh(Points points, Triangles triangles);

  Index vertexCount() const { return static_cast<Index>(points_.rows()); }
  Index faceCount() const { return static_cast<Index>(triangles_.rows()); }
  Index halfedgeCount() const { return 3 * faceCount(); }
  Index edgeCount() const { return static_cast<Index>(edgeHalfedge_.size()); }

  const Points& points() const { return points_; }
  const Triangles& triangles() const { return triangles_; }
  Vec3 point(Index v) const { return points_.row(v); }
  Index vertex(Index f, int corner) const { return triangles_(f, corner); }

  // Connectivity -----------------------------------------------------------------------------------------------------
  static Index face(Index h) { return h / 3; }
  static int corner(Index h) { return h % 3; }
  static Index halfedge(Index f, int corner) { return 3 * f + corner; }
  static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static Index prev(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
  Index tail(Index h) const { return triangles_.data()[h]; }
  Index head(Index h) const { return triangles_.data()[next(h)]; }
  /// The opposite halfedge, or kNone on the boundary.
  Index twin(Index h) const { return twin_[h]; }
  Index edge(Index h) const { return edge_[h]; }
  /// The canonical halfedge of an edge: both faces derive what they must agree on from this one.
  Index edgeHalfedge(Index e) const { return edgeHalfedge_[e]; }
  bool isBoundaryVertex(Index v) const { return boundaryVertex_[v] != 0; }
  /// First outgoing halfedge of a vertex (kNone for an unused one): at a boundary the clockwise-most, so that
  /// nextOutgoing visits every face of the fan.
  Index outgoing(Index v) const { return outgoing_[v]; }
  /// The outgoing halfedge counter-clockwise of h around its tail, or kNone when the boundary or the start is reached.
  Index nextOutgoing(Index h) const {
    const Index n = twin_[prev(h)];
    return n == outgoing_[tail(h)] ? kNone : n;
  }

  /// Component of a vertex, or kNone for an unused one. Components are numbered by their first vertex.
  Index component(Index v) const { return component_[v]; }
  Index componentCount() const { return componentCount_; }
  Index boundaryLoopCount() const { return boundaryLoopCount_; }
  /// V - E + F over the used vertices.
  Index eulerCharacteristic() const { return eulerCharacteristic_; }
  /// Faces whose orientation was reversed on construction, 0 when the input agreed with itself.
  Index flippedFaceCount() const { return flippedFaceCount_; }

  // Geometry ---------------------------------------------------------------------------------------------------------
  double edgeLength(Index e) const { return edgeLength_[e]; }
  double faceArea(Index f) const { return faceArea_[f]; }
  Vec3 faceNormal(Index f) const;
  /// Interior angle of face(h) at tail(h), radians.
  double cornerAngle(Index h) const { return cornerAngle_[h]; }
  /// A third of the area of the vertex's faces.
  double vertexArea(Index v) const { return vertexArea_[v]; }
  double totalArea() const { return totalArea_; }
  /// Square root of the total area: the "size of the object" that scale-free settings refer to.
  double size() const;
  double meanEdgeLength() const { return meanEdgeLength_; }

 private:
  void numberEdges();
  void findComponents(const std::vector<Index>& faceComponent);
  void measure();

  Points points_;
  Triangles triangles_;
  std::vector<Index> twin_, edge_, edgeHalfedge_, outgoing_, component_;
  std::vector<char> boundaryVertex_;
  std::vector<double> edgeLength_, faceArea_, cornerAngle_, vertexArea_;
  Index componentCount_ = 0, boundaryLoopCount_ = 0, eulerCharacteristic_ = 0, flippedFaceCount_ = 0;
  double totalArea_ = 0.0, meanEdgeLength_ = 0.0;
};

}  // namespace stormfield
