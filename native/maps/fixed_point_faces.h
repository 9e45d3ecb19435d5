// The faces that hold a fixed point of a field: each of them is a recurrent node of every combinatorial map.
//
//   const std::vector<char> holds = fixedPointFaces(field);
#pragma once

#include <vector>

#include "field/vector_field.h"

namespace stormfield {

/// Per face 1 where it holds a fixed point, inside or on its border, else 0: faces with a Poincare index, faces with a
/// zero vector at a corner, and both faces of an edge along which the field changes its sign.
std::vector<char> fixedPointFaces(const VectorField& field);

}  // namespace stormfield
