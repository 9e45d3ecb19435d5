// Compiled with -mavx2 (native/CMakeLists.txt): nothing but templates that no other file instantiates may be used here,
// or the linker could take these for older processors too.
#include "tracing/detail/face_step.h"
#include "tracing/detail/unsteady_step.h"

namespace stormfield::lanes {

#ifdef __AVX2__
StepEight stepEightForAvx2(bool curved) {
  if (curved) return [](ParticlesOf<8>& p, const KernelLimits& l) { FaceStepKernel<32, 8, true>::step(p, 0, l); };
  return [](ParticlesOf<8>& p, const KernelLimits& l) { FaceStepKernel<32, 8, false>::step(p, 0, l); };
}

UnsteadyStep unsteadyStepForAvx2() {
  return UnsteadyStepKernel<32>::step;
}
#endif

}  // namespace stormfield::lanes
