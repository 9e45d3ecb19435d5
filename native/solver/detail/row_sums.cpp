#include "solver/detail/row_sums.h"

#include "base/processor.h"

namespace stormfield::kernels {

#ifdef STORMFIELD_AVX2
RowSums rowSumsForAvx2();
#endif

const RowSums& rowSums() {
  static const RowSums table = [] {
#ifdef STORMFIELD_AVX2
    if (hasAvx2()) return rowSumsForAvx2();
#endif
    return RowSumsOf<16>::table();
  }();
  return table;
}

}  // namespace stormfield::kernels
