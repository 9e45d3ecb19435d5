// Vectors turned by one angle inside a block, by less towards its border (Duff 1953, Limit-cycles and rotated vector
// fields; Perko 2001, section 4.6).
//
// Zeros stay where they are. In such a family every periodic orbit moves to one of its sides as the angle grows, until it
// shrinks to a fixed point, meets another orbit, or meets a saddle in a homoclinic loop: the ways in which orbits are
// cancelled. All angles of one sign move an orbit to one side.
//
//   const std::vector<VectorField> fills = rotationFills(field, freeVertices);
#pragma once

#include <vector>

#include "field/vector_field.h"

namespace stormfield {

/// By rising angle, both signs of each; given vectors keep their bits. freeVertices: ascending.
std::vector<VectorField> rotationFills(const VectorField& field, const std::vector<Index>& freeVertices);

}  // namespace stormfield
