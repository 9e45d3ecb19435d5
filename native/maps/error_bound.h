// The geometry-based map of every field within an error bound (thesis 6.1, 6.4; the enlarged map of section 6.4 made
// exact). The vector at a vertex v is known up to epsilon * weight(v), and F has every edge that any such field has.
//
// The component across a mesh edge is linear between its ends. So some field within the bound crosses the edge outwards
// just when epsilon reaches the smaller of -c / w at the two ends (c the outward component, w the weight). A face can
// hold a fixed point just when epsilon reaches the least |V| / w on it, of which a lower bound is taken: the distance of
// the origin from the triangle of the three carried vectors, less their twist. Every edge of F so has a least epsilon,
// and F of one epsilon contains F of every field within it. Recurrent components, and all that follows from them,
// therefore contain those of every field within the bound. Szymczak 2011 ("Stable Morse decompositions for piecewise
// constant vector fields on surfaces") bounds fields that are constant on faces in this way.
//
// epsilon in mesh units per second, weights without unit.
//
//   const ErrorBoundedMap bounded = errorBoundedMap(field, {});
//   const CombinatorialMap map = mapWithinEpsilon(bounded, 0.1);
#pragma once

#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "maps/combinatorial_map.h"

namespace stormfield {

/// Every edge that F can have, with the least epsilon from which F has it.
struct ErrorBoundedMap {
  CombinatorialMap map;
  /// Per edge, in the order of map.graph.targets: 0 for the edges of the field itself, infinite for those that no field
  /// has.
  std::vector<double> edgeEpsilon;
  /// Per face the least epsilon from which it can hold a fixed point: that of its edge to itself.
  std::vector<double> faceEpsilon;
};

/// weights: one per vertex, not negative, factors of epsilon; empty for 1 everywhere. At epsilon 0 the map is
/// geometryMap(field) with edges of fixedPointFaces(field) to themselves, and flow crosses the edges that it runs along
/// both ways (they are not transverse: thesis 2.4.2). The same bits for any number of threads. Throws InputError for a
/// wrong number of weights, and for a weight that is not a number >= 0 (the message names the vertex).
ErrorBoundedMap errorBoundedMap(const VectorField& field, const std::vector<double>& weights);
/// Throws Cancelled too.
ErrorBoundedMap errorBoundedMap(const VectorField& field, const std::vector<double>& weights, Progress& progress);

/// F for all fields within epsilon >= 0.
CombinatorialMap mapWithinEpsilon(const ErrorBoundedMap& bounded, double epsilon);
/// Per face whether it can hold a fixed point of a field within epsilon.
std::vector<char> fixedPointFacesWithinEpsilon(const ErrorBoundedMap& bounded, double epsilon);

/// ErrorBoundedMap::faceEpsilon alone. Throws InputError as errorBoundedMap does.
std::vector<double> fixedPointEpsilons(const VectorField& field, const std::vector<double>& weights);
/// One weight per vertex, 1 where none were given. Throws InputError as errorBoundedMap does.
std::vector<double> checkedWeights(const VectorField& field, const std::vector<double>& weights);

/// Mean of |V| over the area of the surface (by vertices), the unit of relative bounds.
double meanSpeed(const VectorField& field);

}  // namespace stormfield
