#include "solver/detail/row_sums.h"

namespace stormfield::kernels {

#ifdef STORMFIELD_AVX2
RowSums rowSumsForAvx2();
#endif

const RowSums& rowSums() {
  static const RowSums table = [] {
#ifdef STORMFIELD_AVX2
    if (__builtin_cpu_supports("avx2")) return rowSumsForAvx2();
#endif
    return RowSumsOf<16>::table();
  }();
  return table;
}

}  // namespace stormfield::kernels
