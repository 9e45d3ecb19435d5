// The steps from a list of triangles to an oriented 2-manifold; TriangleMesh runs them in this order.
//
// Each step throws MeshError naming the element and the cure when the input cannot be used.
#pragma once

#include <vector>

#include "base/types.h"

namespace stormfield {

/// Refuses a mesh without faces, coordinates that are not finite, indices out of range, faces that use a vertex twice
/// and faces without area.
void checkTriangles(const Points& points, const Triangles& triangles);

/// The other halfedge on the same edge, whatever its direction, or kNone. Refuses faces given twice and edges with more
/// than two faces.
std::vector<Index> pairHalfedges(Index vertexCount, const Triangles& triangles);

struct Orientation {
  std::vector<Index> faceComponent;  ///< per face, numbered by first face
  Index componentCount = 0;
  Index flippedFaceCount = 0;
};

/// Flips the minority of the faces of each component (the first face's side wins a tie) so that all agree, and renames
/// the halfedges in mate accordingly: mate becomes the table of twins. Refuses surfaces that cannot be oriented.
Orientation orientFaces(Triangles& triangles, std::vector<Index>& mate);

/// First outgoing halfedge per vertex: the clockwise-most of the fan at a boundary, the lowest elsewhere; kNone for
/// vertices that no face uses. Refuses vertices with two fans.
std::vector<Index> firstOutgoing(Index vertexCount, const Triangles& triangles, const std::vector<Index>& twin);

}  // namespace stormfield
