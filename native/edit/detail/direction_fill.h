// Directions with as few zeros as the border of a region allows (Crane, Desbrun, Schroeder 2010, Trivial Connections on
// Discrete Surfaces, here for vectors at vertices), with lengths whose logarithms are harmonic.
//
// The unknown of an edge is the rotation of the field along it. Around a face the rotations add up to 2 pi times its
// index (field/poincare_index.h), and between given vectors they are given. Of all rotations that fulfil this those
// of least energy, sum of w rotation^2, are taken: a rotation that fulfils it, found along a tree of faces, plus the
// difference of a potential. The potential is constant on each connected part of the given vertices, up to full turns:
// each choice of turns is another fill. So are other places for the zeros.
//
// Where the free vertices hang together with a handle of the surface, there is no fill by this method.
#pragma once

#include <vector>

#include "field/vector_field.h"

namespace stormfield {

struct DirectionFillOptions {
  std::vector<Index> zeroFaces = {};  ///< where zeros are put first, if any must be
  int placements = 4;                 ///< of zeros that are tried
  int turns = 3;                      ///< fills per placement, by rising energy
};

/// From the one of least energy to others; given vectors keep their bits. freeVertices: ascending.
std::vector<VectorField> directionFills(const VectorField& field, const std::vector<Index>& freeVertices,
                                        const DirectionFillOptions& options = {});

}  // namespace stormfield
