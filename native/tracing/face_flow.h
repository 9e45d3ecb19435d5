// A steady field in one face, ready to be followed: what tracing/face_path.h needs of the face and of the field, in two
// lines of cache.
//
// The carried vectors u_i (tracing/flat_faces.h) are kept as the rates at which they move the barycentric coordinates
// of corners 1 and 2, in a unit of time in which the fastest is 1, and lengths in units of the side between corners 0
// and 1, so that no scale of mesh or field leaves single precision.
#pragma once

#include <array>
#include <memory>

#include "base/types.h"

namespace stormfield {

class FlatFace;
class FlatFaces;
class SteadyFlow;

struct alignas(64) FaceFlow {
  double rate[3][2];    ///< of the corners' carried vectors
  double foot, height;  ///< of corner 2 over the base
  double base;          ///< mesh units
  double unit;          ///< of time, seconds; 0 where the face needs the library's functions, or the field is zero
  float doubleTwist[3], tanHalf[3];  ///< as in FlatFace
  Index twin[3];
  float longestSide;
  float bend;  ///< bound of the correction for curvature, bases per unit of time

  FaceFlow() = default;
  FaceFlow(const FlatFace& face, const std::array<Complex, 3>& values);
};
static_assert(sizeof(FaceFlow) == 128);

/// Of all faces, for many traces: what SteadyFlow takes as prepared.
std::unique_ptr<FaceFlow[]> prepareFaces(const FlatFaces& faces, const SteadyFlow& flow);

}  // namespace stormfield
