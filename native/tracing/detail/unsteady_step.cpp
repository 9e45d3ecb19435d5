#include "tracing/detail/unsteady_step.h"

#include "base/processor.h"

namespace stormfield::lanes {

UnsteadyStep unsteadyStep() {
#ifdef STORMFIELD_AVX2
  if (hasAvx2()) return unsteadyStepForAvx2();
#endif
#ifdef __SSE2__
  return UnsteadyStepKernel<16>::step;
#else
  return UnsteadyStepKernel<4>::step;
#endif
}

}  // namespace stormfield::lanes
