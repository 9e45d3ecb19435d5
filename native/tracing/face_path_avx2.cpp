// Compiled with -mavx2 (native/CMakeLists.txt): nothing but templates that no other file instantiates may be used here,
// or the linker could take these for older processors too.
#include "tracing/face_step_kernel.h"

namespace stormfield::lanes {

#ifdef __AVX2__
using StepEight = void (*)(ParticlesOf<8>&, const KernelLimits&);
StepEight stepEightForAvx2();
StepEight stepEightForAvx2() {
  return
      [](ParticlesOf<8>& particles, const KernelLimits& limits) { FaceStepKernel<32, 8>::step(particles, 0, limits); };
}
#endif

}  // namespace stormfield::lanes
