// The geometry-based combinatorial map (thesis 2.4.2, 6.2; Chen et al. 2007, "Vector field editing and periodic orbit
// extraction using Morse decomposition"): F has the edge a -> b where flow crosses the common edge of the faces from a
// to b.
//
// Along an edge the field is the linear blend of the two carried end vectors, the same from both faces (thesis 2.5).
// Its component across the edge is linear too, so that the two ends decide the directions in which flow crosses: none,
// one, or both. A face that holds a fixed point has an edge to itself. A boundary edge that flow crosses outwards leads
// to outside(). A fixed point on an edge or at a vertex lies in all faces there: they lead to each other both ways.
//
//   const CombinatorialMap map = geometryMap(field);
//   const Components components = stronglyConnectedComponents(map.graph);
#pragma once

#include <cstdint>
#include <vector>

#include "field/vector_field.h"
#include "maps/combinatorial_map.h"

namespace stormfield {

/// The field at the two ends of an edge, in the frame of a halfedge h of it: the real part points along h, the imaginary
/// part across it, into face(h). A component across of round-off size (1e-14 of its vector) is 0.
struct EndVectors {
  Complex tail, head;
};
EndVectors endVectors(const VectorField& field, Index h);

/// Whether a fixed point lies on the edge: at an end, or between ends that both point along the edge, one each way.
bool holdsFixedPointOnEdge(const EndVectors& ends);

/// The directions in which flow crosses an edge, in the frame of its canonical halfedge h = mesh.edgeHalfedge(e).
struct EdgeDirections {
  bool inwards = false;   ///< somewhere into face(h), on the left of h
  bool outwards = false;  ///< somewhere out of face(h), into the face of the twin or over the boundary
};

/// One per edge, exact. Flow crosses an edge with a fixed point on it both ways.
std::vector<EdgeDirections> edgeDirections(const VectorField& field);

/// The same for any number of threads.
CombinatorialMap geometryMap(const VectorField& field);

}  // namespace stormfield
