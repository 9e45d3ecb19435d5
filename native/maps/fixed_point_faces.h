// The faces that hold a fixed point of a field, as a combinatorial map sees them: each of them is a recurrent node of
// F.
#pragma once

#include <vector>

#include "field/vector_field.h"

namespace stormfield {

/// Per face 1 where it holds a fixed point, inside or on its boundary: the faces that geometryMap gives an edge to
/// themselves, and both faces of an edge with opposed ends along it.
std::vector<char> fixedPointFaces(const VectorField& field);

}  // namespace stormfield
