// A steady field's path through one face in one step: across it, or as far as one step is exact enough.
//
// In the flat frame of a face the interpolated field is V = L + c: L is affine, and c, the correction for curvature, is
// as small as the twist of the corners (tracing/flat_faces.h). The path of L and of the constant that c is near the
// middle of the way is a Taylor series that needs no further evaluation of the field; what the rest of c adds is
//     e(t) = integral of exp(J (t - s)) (c(x(s)) - constant) ds,      J the Jacobian of L,
// by Gauss' rule, looked at again at the displaced points where the twist is large. The estimated error, of series,
// rule and displacement together, is within the tolerance; a step that would exceed it ends inside the face.
//
// One particle at a time or eight side by side, each in a face of its own: every particle's result is the same either
// way, and on every processor.
#pragma once

#include <limits>

#include "tracing/face_flow.h"
#include "tracing/face_step_kernel.h"
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

/// From a point of a side, which flows into the face, or from inside it (entry -1, barycentric coordinates). False, and
/// no step, where the path is not plain: near a vertex, touching an edge, slower than the least speed, in a face that
/// needs the library's functions.
bool stepThroughFace(const FaceFlow& face, const SidePoint& entry, const Eigen::Vector3d& inside,
                     const StepLimits& limits, FaceStep& step);

/// Particles side by side, each on its way through its own face.
class FaceSteps {
 public:
  static constexpr int kCount = 8;

  FaceSteps();

  /// Particle i's next step. The face must outlive it.
  void set(int i, const FaceFlow& face, const SidePoint& entry, const Eigen::Vector3d& inside, double maximalDuration);
  /// What take says of a step.
  enum class Outcome {
    Done,      ///< the step is as wanted
    Shorter,   ///< it would not be exact enough: the next advance tries a shorter one
    NotPlain,  ///< see stepThroughFace
  };
  /// One try of a step for all particles; those never set stay idle.
  void advance(const StepLimits& limits);
  Outcome take(int i, FaceStep& step);

 private:
  lanes::ParticlesOf<kCount> particles_;
  int tries_[kCount];
};

}  // namespace stormfield
