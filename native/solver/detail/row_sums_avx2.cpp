// Compiled with -mavx2 (native/CMakeLists.txt): nothing but templates that no other file instantiates may be used here,
// or the linker could take these for older processors too.
#include "solver/detail/row_sums.h"

namespace stormfield::kernels {

#ifdef __AVX2__
RowSums rowSumsForAvx2();
RowSums rowSumsForAvx2() {
  return RowSumsOf<32>::table();
}
#endif

}  // namespace stormfield::kernels
