#include "tracing/face_path.h"

#include <cmath>

namespace stormfield {
namespace lanes {

using StepEight = void (*)(ParticlesOf<FaceSteps::kCount>&, const KernelLimits&);
#ifdef STORMFIELD_AVX2
StepEight stepEightForAvx2();
#endif

namespace {

#ifdef __SSE2__
constexpr int kWidth = 16;
#else
constexpr int kWidth = 4;
#endif

StepEight stepEight() {
#ifdef STORMFIELD_AVX2
  if (__builtin_cpu_supports("avx2")) return stepEightForAvx2();
#endif
  return [](ParticlesOf<FaceSteps::kCount>& particles, const KernelLimits& limits) {
    using Kernel = FaceStepKernel<kWidth, FaceSteps::kCount>;
    for (int first = 0; first < FaceSteps::kCount; first += Kernel::kLanes) Kernel::step(particles, first, limits);
  };
}

}  // namespace
}  // namespace lanes

namespace {

/// Tries of one step, each shorter than the one before.
constexpr int kMostTries = 6;

lanes::KernelLimits kernelLimits(const StepLimits& limits) {
  return {limits.tolerance, limits.relativeTolerance, std::sqrt(limits.squaredMinimalSpeed)};
}

template <int Count>
void setParticle(lanes::ParticlesOf<Count>& particles, int i, const FaceFlow& face, const SidePoint& entry,
                 const Eigen::Vector3d& inside, double maximalDuration) {
  particles.face[i] = &face;
  particles.longest[i] = maximalDuration;
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

template <int Count>
FaceSteps::Outcome takeStep(lanes::ParticlesOf<Count>& particles, int i, FaceStep& step) {
  const int exit = static_cast<int>(particles.exit[i]);
  if (exit == lanes::kNotPlain) return FaceSteps::Outcome::NotPlain;
  if (exit == lanes::kTooLong) {
    particles.longest[i] = particles.duration[i];
    return FaceSteps::Outcome::Shorter;
  }
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
  return FaceSteps::Outcome::Done;
}

}  // namespace

bool stepThroughFace(const FaceFlow& face, const SidePoint& entry, const Eigen::Vector3d& inside,
                     const StepLimits& limits, FaceStep& step) {
  lanes::ParticlesOf<1> particle;
  setParticle(particle, 0, face, entry, inside, limits.maximalDuration);
  for (int i = 0; i < kMostTries; ++i) {
    lanes::FaceStepKernel<4, 1>::step(particle, 0, kernelLimits(limits));
    const FaceSteps::Outcome outcome = takeStep(particle, 0, step);
    if (outcome != FaceSteps::Outcome::Shorter) return outcome == FaceSteps::Outcome::Done;
  }
  return false;
}

FaceSteps::FaceSteps() {
  static const FaceFlow nowhere{};
  for (int i = 0; i < kCount; ++i) set(i, nowhere, {}, Eigen::Vector3d::Constant(1.0 / 3.0), 0.0);
}

void FaceSteps::set(int i, const FaceFlow& face, const SidePoint& entry, const Eigen::Vector3d& inside,
                    double maximalDuration) {
  setParticle(particles_, i, face, entry, inside, maximalDuration);
  tries_[i] = 0;
}

void FaceSteps::advance(const StepLimits& limits) {
  static const lanes::StepEight step = lanes::stepEight();
  step(particles_, kernelLimits(limits));
}

FaceSteps::Outcome FaceSteps::take(int i, FaceStep& step) {
  const Outcome outcome = takeStep(particles_, i, step);
  return outcome == Outcome::Shorter && ++tries_[i] == kMostTries ? Outcome::NotPlain : outcome;
}

}  // namespace stormfield
