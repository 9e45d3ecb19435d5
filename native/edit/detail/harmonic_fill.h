// The constrained Laplace equation over a region (thesis 4.2, equation 4.1): the field of least energy
// sum over edges of w |V_head - transport V_tail|^2 whose vectors at all vertices but the free ones are given, with the
// weights of solver/connection_laplacian.h. One sparse Cholesky factorisation; the vectors that are not free keep their
// bits.
//
//   const VectorField smooth = harmonicFill(field, freeVertices);
#pragma once

#include <vector>

#include "field/vector_field.h"

namespace stormfield {

/// freeVertices: ascending; each connected part of them has a neighbour that is not free (InputError otherwise).
VectorField harmonicFill(const VectorField& field, const std::vector<Index>& freeVertices);
/// Largest residual of the equation at a free vertex: the distance of its vector from the weighted mean of its
/// neighbours', as a fraction of the largest vector at and around the free vertices.
double harmonicResidual(const VectorField& field, const std::vector<Index>& freeVertices);

}  // namespace stormfield
