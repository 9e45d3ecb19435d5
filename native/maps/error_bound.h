// The geometry-based map of every field within an error bound (thesis 6.1, 6.4; the enlarged map of section 6.4 made
// exact): the vectors at the vertices are known up to epsilon * weight(v), and F gets every edge that any such field
// has.
//
// The component across a mesh edge is linear between its ends, so that some field within the bound crosses the edge
// outwards just when epsilon reaches the smaller of -c / w at its two ends (c the outward component, w the weight). A
// face can hold a fixed point just when epsilon reaches min |V| / w on it, of which a lower bound is taken: the
// distance of the origin from the triangle of the three carried vectors, less their twist. So every edge of F gets the
// least epsilon from which it is there, and F of one epsilon contains F of every field within it. Strongly connected
// sets, and all that follows from them, therefore contain those of every field within the bound.
//
//   const ErrorBoundedMap bounded = errorBoundedMap(field, {});
//   const CombinatorialMap map = mapWithinEpsilon(bounded, 0.1);  // fields within 0.1 mesh units per second
#pragma once

#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "maps/combinatorial_map.h"

namespace stormfield {

/// Every edge that F can have, each with the least epsilon from which it is there; 0 for the edges of F itself.
struct ErrorBoundedMap {
  CombinatorialMap map;
  std::vector<double> edgeEpsilon;  ///< per edge, in the order of map.graph.targets; infinite where it never comes
  std::vector<double> faceEpsilon;  ///< per face the epsilon from which it can hold a fixed point: that of its loop
};

/// weights: one per vertex, not negative, epsilon is multiplied by them; empty for 1 everywhere. Throws InputError
/// naming the vertex. At epsilon 0 the map is geometryMap(field) and the loops of fixedPointFaces(field), and edges
/// along which the field runs are crossed both ways (they are not transverse: thesis 2.4.2). The same for any number of
/// threads.
ErrorBoundedMap errorBoundedMap(const VectorField& field, const std::vector<double>& weights);
/// Throws Cancelled too.
ErrorBoundedMap errorBoundedMap(const VectorField& field, const std::vector<double>& weights, Progress& progress);

/// F for all fields within epsilon >= 0.
CombinatorialMap mapWithinEpsilon(const ErrorBoundedMap& bounded, double epsilon);
/// Per face whether it can hold a fixed point of a field within epsilon.
std::vector<char> fixedPointFacesWithinEpsilon(const ErrorBoundedMap& bounded, double epsilon);

/// Per face the epsilon from which it can hold a fixed point, 0 where it does. Throws InputError naming the vertex.
std::vector<double> fixedPointEpsilons(const VectorField& field, const std::vector<double>& weights);
/// One weight per vertex, also where none were given. Throws InputError naming the vertex.
std::vector<double> checkedWeights(const VectorField& field, const std::vector<double>& weights);

/// Mean of |V| over the area of the surface (by vertices), the unit of relative bounds.
double meanSpeed(const VectorField& field);

}  // namespace stormfield
