// The zero of the interpolated field inside one face (thesis 2.2.3).
//
// Newton's method from the zero of the linear blend finds almost all zeros. Where it leaves the face or stalls, the
// face is cut in four again and again, and the piece around which the field winds is kept (bisection by degree: Greene
// 1992). That always converges: a field that winds around a region has a zero in it.
//
//   const FaceInterpolant local = faceInterpolant(field, face);
//   const Eigen::Vector3d zero = findZero(local, poincareIndices(field)[face]);
#pragma once

#include "field/interpolation.h"

namespace stormfield {

/// A zero of the field, of the sign of index where there are several; barycentric coordinates >= 0 with sum 1. Where
/// the face's boundary holds the zero (a vertex with a zero vector, an edge with opposed ends), that point is returned.
/// index: the face's Poincare index, not 0.
Eigen::Vector3d findZero(const FaceInterpolant& local, int index);

}  // namespace stormfield
