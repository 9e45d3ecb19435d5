// Reproducible random numbers by position in a sequence, the same on every machine.
#pragma once

#include <cstdint>

namespace stormfield {

/// A well mixed function of its argument (the finalizer of SplitMix64).
inline std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

/// Uniform in [0, 1), one number for every set of arguments.
template <typename... Integers>
double uniform(std::uint64_t seed, Integers... at) {
  std::uint64_t h = mixed(seed);
  ((h = mixed(h ^ static_cast<std::uint64_t>(at))), ...);
  return static_cast<double>(h >> 11U) * 0x1p-53;
}

}  // namespace stormfield
