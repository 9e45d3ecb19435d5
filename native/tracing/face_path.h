// A steady field's path through one face in one step: across it, or as far as one step is exact enough.
//
// In the flat frame of a face the interpolated field is V = L + c: L is affine, and c, the correction for curvature, is
// as small as the twist of the corners (tracing/flat_faces.h). The path of L is a Taylor series that needs no further
// evaluation of the field; what c adds is
//     e(t) = integral of exp(J (t - s)) c(x(s)) ds,      J the Jacobian of L,
// by Gauss' rule, whose four points are looked at side by side, and again at the displaced points where the twist is
// large. The estimated error, of series, rule and displacement together, is within the tolerance; a step that would
// exceed it ends inside the face.
#pragma once

#include <limits>

#include "tracing/flat_faces.h"

namespace stormfield {

/// A point of a side, at a fraction of its length from its tail.
struct SidePoint {
  int side = -1;
  double fraction = 0.0;
};

struct FaceStep {
  SidePoint exit;               ///< side -1: the step ends inside
  Eigen::Vector3d barycentric;  ///< where, if so
  double duration = 0.0;        ///< seconds
  double length = 0.0;          ///< mesh units
};

struct StepLimits {
  double tolerance = 0.0;          ///< largest estimated error, mesh units
  double relativeTolerance = 0.0;  ///< the same, as a fraction of the length of the path
  double squaredMinimalSpeed = 0.0;
  double maximalDuration = std::numeric_limits<double>::infinity();  ///< seconds; the step may end exactly there
};

/// From a point of a side, which flows into face f, or from inside it (entry -1, barycentric coordinates). values: the
/// vectors at the vertices, in their charts. False, and no step, where the path is not plain: near a vertex, touching
/// an edge, slower than the least speed, in a face that needs the library's functions.
bool stepThroughFace(const FlatFaces& faces, Index f, const std::array<Complex, 3>& values, const SidePoint& entry,
                     const Eigen::Vector3d& inside, const StepLimits& limits, FaceStep& step);

}  // namespace stormfield
