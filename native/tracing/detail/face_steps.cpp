#include "tracing/detail/face_steps.h"

#include <algorithm>

#include "base/processor.h"

namespace stormfield {
namespace lanes {

namespace {

#ifdef __SSE2__
constexpr int kWidth = 16;
#else
constexpr int kWidth = 4;
#endif

template <bool Curved>
void stepEight(ParticlesOf<8>& particles, const KernelLimits& limits) {
  using Kernel = FaceStepKernel<kWidth, 8, Curved>;
  for (int first = 0; first < 8; first += Kernel::kLanes) Kernel::step(particles, first, limits);
}

StepEight choose(bool curved) {
#ifdef STORMFIELD_AVX2
  if (hasAvx2()) return stepEightForAvx2(curved);
#endif
  return curved ? stepEight<true> : stepEight<false>;
}

}  // namespace
}  // namespace lanes

std::span<const int> FaceSteps::advance() {
  static const lanes::StepEight stepFlat = lanes::choose(false), stepCurved = lanes::choose(true);
  for (int k = 0; k < freshCount_; ++k) {
    (isFlatEnough(*particles_.face[fresh_[k]], limits_) ? flat_ : curved_).add(fresh_[k]);
  }
  freshCount_ = 0;
  const bool curved = advancedCurved_ = curved_.count >= flat_.count;
  Queue& queue = curved ? curved_ : flat_;
  const int count = std::min(queue.count, kLanes);
  if (count == 0) return {};
  for (int lane = 0; lane < kLanes; ++lane) {
    // Idle lanes repeat the first.
    const int i = queue.items[lane < count ? lane : 0];
    lanes_.face[lane] = particles_.face[i];
    lanes_.start[0][lane] = particles_.start[0][i];
    lanes_.start[1][lane] = particles_.start[1][i];
    lanes_.entry[lane] = particles_.entry[i];
    lanes_.maxDuration[lane] = particles_.maxDuration[i];
  }
  for (int lane = 0; lane < count; ++lane) {
    chosen_[lane] = queue.items[lane];
    lane_[chosen_[lane]] = lane;
  }
  std::copy(queue.items + count, queue.items + queue.count, queue.items);
  queue.count -= count;
  (curved ? stepCurved : stepFlat)(lanes_, kernelLimits_);
  return {chosen_, static_cast<std::size_t>(count)};
}

}  // namespace stormfield
