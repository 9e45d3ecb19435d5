// What the space-time solve must meet: values at vertices and lambda samples (thesis 4.2, 11.1.3.1).
#pragma once

#include <string>
#include <vector>

#include "base/types.h"

namespace stormfield {

/// Structure of arrays, one entry per constraint, in any order.
///
/// A soft constraint adds weight * |V - value|^2, integrated over the surface (mesh size units, see
/// TriangleMesh::size) and over lambda, to the energy whose minimum is the solution; weight is therefore a density and
/// means the same on a finer mesh or with more samples. Soft constraints on one vertex and sample add up. An infinite
/// weight is a hard constraint: the solution equals value there.
struct ConstraintSet {
  std::vector<Index> vertex;
  std::vector<Index> sample;
  std::vector<Complex> value;  ///< in the chart of the vertex
  std::vector<double> weight;  ///< > 0, infinity when hard
  std::vector<Index> element;  ///< index into elementNames
  std::vector<std::string> elementNames;

  std::size_t size() const { return vertex.size(); }
  void add(Index atVertex, Index atSample, Complex target, double withWeight, Index ofElement) {
    vertex.push_back(atVertex);
    sample.push_back(atSample);
    value.push_back(target);
    weight.push_back(withWeight);
    element.push_back(ofElement);
  }
};

}  // namespace stormfield
