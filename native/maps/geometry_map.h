// The geometry-based combinatorial map (thesis 2.4.2, 6.2): a -> b where flow crosses the common edge from a to b.
//
// The field along an edge is the linear blend of its two carried end vectors, the same from both faces (thesis 2.5), so
// its component across the edge is linear, and the directions of crossing follow from its two ends alone: none, one, or
// both. A face that holds a fixed point has an edge to itself; a boundary edge that is crossed outwards leads to
// outside(). A fixed point on an edge or at a vertex lies in all faces there: they lead to each other both ways.
#pragma once

#include <cstdint>
#include <vector>

#include "field/vector_field.h"
#include "maps/combinatorial_map.h"

namespace stormfield {

/// The field's two end vectors on an edge seen along its halfedge h: the real part points along h, the imaginary part
/// across it, into face(h). A component across of round-off size (1e-14 of its vector) is 0.
struct EndVectors {
  Complex tail, head;
};
EndVectors endVectors(const VectorField& field, Index h);

/// Whether a fixed point lies on the edge, at an end or between opposed ends along it.
bool holdsFixedPointOnEdge(const EndVectors& ends);

/// The directions in which flow crosses an edge, seen along its canonical halfedge h = mesh.edgeHalfedge(e).
struct EdgeDirections {
  bool inwards = false;   ///< somewhere into face(h), which stands on the left
  bool outwards = false;  ///< somewhere out of it, into the face of the twin or over the boundary
};

/// One per edge, exact. Edges with a fixed point on them are crossed both ways.
std::vector<EdgeDirections> edgeDirections(const VectorField& field);

/// The same for any number of threads.
CombinatorialMap geometryMap(const VectorField& field);

}  // namespace stormfield
