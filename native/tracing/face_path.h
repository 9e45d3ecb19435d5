// A steady field's path through one face in one step: across it, or as far as one step is exact enough.
//
// In the flat frame of a face the interpolated field is V = L + c: L is affine, and c, the correction for curvature, is
// as small as the twist of the corners (tracing/flat_faces.h). The path of L plus the value of c near the middle of the
// path is a Taylor series that needs no further evaluation of the field; what c less that constant adds is
//     e(t) = integral of exp(J (t - s)) (c(x(s)) - constant) ds,      J the Jacobian of L,
// by Gauss' rule, repeated at the displaced points where the twist is large. Where c is far below the tolerance all
// over the face it is left out. The estimated error, of series, rule and displacement together, is within the
// tolerance; a step that would exceed it ends inside the face.
//
// For many particles at a time see tracing/face_steps.h: every particle's result is the same either way, and on every
// processor.
#pragma once

#include <limits>

#include "tracing/detail/face_step.h"
#include "tracing/face_flow.h"
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
  double squaredMinSpeed = 0.0;
  double maxDuration = std::numeric_limits<double>::infinity();  ///< seconds; the step may end exactly there
};

/// From a point of a side, which flows into the face, or from inside it (entry -1, barycentric coordinates). False, and
/// no step, where the path is not plain: near a vertex, touching an edge, slower than the least speed, in a face that
/// needs the library's functions.
bool stepThroughFace(const FaceFlow& face, const SidePoint& entry, const Eigen::Vector3d& inside,
                     const StepLimits& limits, FaceStep& step);

// What steps of one and of many particles have in common.

/// Tries of one step with the correction, each shorter than the one before.
constexpr int kMaxStepTries = 6;

/// Whether to try first without the correction: if that is no step, one with it may be.
inline bool isFlatEnough(const FaceFlow& face, const StepLimits& limits) {
  constexpr double kFraction = 0.1;
  return static_cast<double>(face.bend) * face.base <= kFraction * limits.tolerance;
}

inline lanes::KernelLimits kernelLimits(const StepLimits& limits) {
  return {limits.tolerance, limits.relativeTolerance, std::sqrt(limits.squaredMinSpeed)};
}

template <int Count>
void setParticle(lanes::ParticlesOf<Count>& particles, int i, const FaceFlow& face, const SidePoint& entry,
                 const Eigen::Vector3d& inside, double maxDuration) {
  particles.face[i] = &face;
  particles.maxDuration[i] = maxDuration;
  if (entry.side < 0) {
    particles.entry[i] = -1.0;
    particles.start[0][i] = inside[1];
    particles.start[1][i] = inside[2];
    return;
  }
  const double s = entry.fraction;
  particles.entry[i] = entry.side == 0 ? 2.0 : entry.side - 1.0;
  particles.start[0][i] = entry.side == 0 ? s : (entry.side == 1 ? 1.0 - s : 0.0);
  particles.start[1][i] = entry.side == 0 ? 0.0 : (entry.side == 1 ? s : 1.0 - s);
}

/// The result of a step whose exit is not kNotPlain or kTooLong.
template <int Count>
void getStep(const lanes::ParticlesOf<Count>& particles, int i, FaceStep& step) {
  const int exit = static_cast<int>(particles.exit[i]);
  const double b1 = particles.end[0][i], b2 = particles.end[1][i];
  step.duration = particles.duration[i];
  step.length = particles.length[i];
  if (exit == lanes::kInside) {
    step.exit = SidePoint{};
    step.barycentric = {1.0 - b1 - b2, b1, b2};
  } else {
    // The side opposite to corner e goes from e + 1 to e + 2.
    step.exit = {exit == 2 ? 0 : exit + 1, exit == 0 ? b2 : (exit == 1 ? 1.0 - b2 : b1)};
  }
}

}  // namespace stormfield
