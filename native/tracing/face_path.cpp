#include "tracing/face_path.h"

#include <cmath>

namespace stormfield {
namespace {

int exitOf(const lanes::ParticlesOf<1>& particle) {
  return static_cast<int>(particle.exit[0]);
}

}  // namespace

bool stepThroughFace(const FaceFlow& face, const SidePoint& entry, const Eigen::Vector3d& inside,
                     const StepLimits& limits, FaceStep& step) {
  lanes::ParticlesOf<1> particle;
  setParticle(particle, 0, face, entry, inside, limits.maxDuration);
  const lanes::KernelLimits bounds = kernelLimits(limits);
  if (isFlatEnough(face, limits)) {
    lanes::FaceStepKernel<4, 1, false>::step(particle, 0, bounds);
    if (exitOf(particle) >= lanes::kInside) {
      getStep(particle, 0, step);
      return true;
    }
  }
  for (int i = 0; i < kMaxStepTries; ++i) {
    lanes::FaceStepKernel<4, 1, true>::step(particle, 0, bounds);
    if (exitOf(particle) == lanes::kNotPlain) return false;
    if (exitOf(particle) >= lanes::kInside) {
      getStep(particle, 0, step);
      return true;
    }
    particle.maxDuration[0] = particle.duration[0];
  }
  return false;
}

}  // namespace stormfield
