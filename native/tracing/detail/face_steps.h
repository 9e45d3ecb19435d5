// Steps through faces (tracing/face_path.h) of many particles, eight of them side by side at a time: those in flat
// faces apart from those in curved ones, which take longer. Every particle's result is the same as that of
// stepThroughFace.
//
//   FaceSteps steps({.tolerance = 1e-6, .relativeTolerance = 1e-4});
//   const FaceFlow flow(faces[p.face], {1.0, 1.0, 1.0});
//   steps.set(0, flow, {}, p.barycentric, 1.0);
//   FaceStep step;
//   for (const int i : steps.advance()) {
//     const bool done = steps.take(i, step) == FaceSteps::Outcome::Done;  // else it waits again, or is not plain
//   }
//
// tracing/side_by_side.h does that for whole traces.
#pragma once

#include <span>

#include "tracing/face_path.h"

namespace stormfield {

class FaceSteps {
 public:
  /// Particles at a time: among 16, eight always wait for the same kind of step.
  static constexpr int kCount = 16;

  /// The limit of duration is each particle's own.
  explicit FaceSteps(const StepLimits& limits) : limits_(limits), kernelLimits_(kernelLimits(limits)) {}

  /// Particle i's next step, which then waits in a queue. The face must outlive it.
  void set(int i, const FaceFlow& face, const SidePoint& entry, const Eigen::Vector3d& inside, double maxDuration) {
    setParticle(particles_, i, face, entry, inside, maxDuration);
    tries_[i] = 0;
    fresh_[freshCount_++] = i;
  }
  /// Tries the steps of up to eight particles that wait, and returns which; each of them has to be taken.
  std::span<const int> advance();
  enum class Outcome {
    Done,      ///< the step is as wanted
    Again,     ///< it would not be exact enough: the particle waits again, to try a shorter one
    NotPlain,  ///< see stepThroughFace
  };
  Outcome take(int i, FaceStep& step) {
    const int lane = lane_[i], exit = static_cast<int>(lanes_.exit[lane]);
    if (exit >= lanes::kInside) {
      getStep(lanes_, lane, step);
      return Outcome::Done;
    }
    if (advancedCurved_) {
      if (exit == lanes::kNotPlain || ++tries_[i] == kMaxStepTries) return Outcome::NotPlain;
      particles_.maxDuration[i] = lanes_.duration[lane];
    }
    curved_.add(i);
    return Outcome::Again;
  }

 private:
  static constexpr int kLanes = 8;
  /// Particles in the order in which they came.
  struct Queue {
    int items[kCount];
    int count = 0;
    void add(int i) { items[count++] = i; }
  };

  StepLimits limits_;
  lanes::KernelLimits kernelLimits_;
  lanes::ParticlesOf<kCount> particles_;
  lanes::ParticlesOf<kLanes> lanes_;
  int lane_[kCount], tries_[kCount], fresh_[kCount], chosen_[kLanes];
  int freshCount_ = 0;
  bool advancedCurved_ = false;
  Queue flat_, curved_;
};

}  // namespace stormfield
