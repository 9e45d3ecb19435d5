// What the processor that runs the program can do.
//
// Asks cpuid and xgetbv itself: __builtin_cpu_supports answers 0 in programs that Clang links without GCC's libgcc.
#pragma once

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace stormfield {

/// Whether processor and operating system both support AVX2: the registers of AVX have to be saved as well.
inline bool hasAvx2() {
#if defined(__x86_64__)
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (!__get_cpuid(1, &a, &b, &c, &d)) return false;
  constexpr unsigned kOsxsave = 1U << 27U, kAvx = 1U << 28U;
  if ((c & kOsxsave) == 0 || (c & kAvx) == 0) return false;
  unsigned low = 0, high = 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  constexpr unsigned kSseAndAvxState = 6U;
  if ((low & kSseAndAvxState) != kSseAndAvxState) return false;
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d)) return false;
  constexpr unsigned kAvx2 = 1U << 5U;
  return (b & kAvx2) != 0;
#else
  return false;
#endif
}

}  // namespace stormfield
