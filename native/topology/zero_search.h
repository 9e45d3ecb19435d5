// Where the interpolated field of one face is zero.
//
// Newton's method from the zero of the linear blend finds almost all; where it leaves the face or stalls, the face is
// cut in four again and again and the part around which the field winds is kept, which cannot fail: a field that winds
// around a region has a zero in it.
#pragma once

#include "field/interpolation.h"

namespace stormfield {

/// A zero of the field, of the sign of index where there are several; barycentric coordinates >= 0 with sum 1. When the
/// face's boundary holds the zero (a vertex with a zero vector, an edge with opposed ends), that point is returned.
Eigen::Vector3d findZero(const FaceInterpolant& local, int index);

}  // namespace stormfield
