// Arithmetic on several numbers side by side, with the same bits for any number of them: one float register and twice
// as many bytes of doubles. Lanes<4> is a single float and a single double.
//
// Templates on the width of a register alone, so that one of them may be compiled for newer processors
// (tracing/face_path_avx2.cpp). Nothing here may use the library: the linker could take its inline functions, compiled
// for those, for older processors too.
#pragma once

#include <cstddef>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace stormfield::lanes {

#define STORMFIELD_LANES_INLINE [[gnu::always_inline]] inline

template <int Bytes>
struct Registers;

template <>
struct Registers<4> {
  using Floats = float;
  using HalfOfDoubles = double;
};
#if defined(__SSE2__)
template <>
struct Registers<16> {
  using Floats = float __attribute__((vector_size(16)));
  using HalfOfDoubles = double __attribute__((vector_size(16)));
};
#endif
#if defined(__AVX2__)
template <>
struct Registers<32> {
  using Floats = float __attribute__((vector_size(32)));
  using HalfOfDoubles = double __attribute__((vector_size(32)));
};
#endif

/// Two registers of doubles, or of what their comparison gives.
template <typename Register>
struct Two {
  Register low, high;
};

template <int Bytes>
struct DoublesOf {
  using Type = Two<typename Registers<Bytes>::HalfOfDoubles>;
};
template <>
struct DoublesOf<4> {
  using Type = double;
};

// What the language has for numbers and single registers, for two of them.
#define STORMFIELD_LANES_OPERATOR(op)                                          \
  template <typename R>                                                        \
  STORMFIELD_LANES_INLINE auto operator op(const Two<R>& a, const Two<R>& b) { \
    return Two<decltype(a.low op b.low)>{a.low op b.low, a.high op b.high};    \
  }                                                                            \
  template <typename R>                                                        \
  STORMFIELD_LANES_INLINE auto operator op(const Two<R>& a, double b) {        \
    return Two<decltype(a.low op b)>{a.low op b, a.high op b};                 \
  }                                                                            \
  template <typename R>                                                        \
  STORMFIELD_LANES_INLINE auto operator op(double a, const Two<R>& b) {        \
    return Two<decltype(a op b.low)>{a op b.low, a op b.high};                 \
  }
STORMFIELD_LANES_OPERATOR(+)
STORMFIELD_LANES_OPERATOR(-)
STORMFIELD_LANES_OPERATOR(*)
STORMFIELD_LANES_OPERATOR(/)
STORMFIELD_LANES_OPERATOR(<)
STORMFIELD_LANES_OPERATOR(<=)
STORMFIELD_LANES_OPERATOR(>)
STORMFIELD_LANES_OPERATOR(>=)
STORMFIELD_LANES_OPERATOR(==)
#undef STORMFIELD_LANES_OPERATOR
template <typename R>
STORMFIELD_LANES_INLINE Two<R> operator&(const Two<R>& a, const Two<R>& b) {
  return {a.low & b.low, a.high & b.high};
}
template <typename R>
STORMFIELD_LANES_INLINE Two<R> operator|(const Two<R>& a, const Two<R>& b) {
  return {a.low | b.low, a.high | b.high};
}
template <typename R>
STORMFIELD_LANES_INLINE Two<R> operator-(const Two<R>& a) {
  return {-a.low, -a.high};
}

/// a where the mask is set, else b.
template <typename Mask, typename R>
STORMFIELD_LANES_INLINE R select(const Mask& mask, const R& a, const R& b) {
  return mask ? a : b;
}
template <typename Mask, typename R>
STORMFIELD_LANES_INLINE Two<R> select(const Two<Mask>& mask, const Two<R>& a, const Two<R>& b) {
  return {mask.low ? a.low : b.low, mask.high ? a.high : b.high};
}
template <typename T>
STORMFIELD_LANES_INLINE T smaller(const T& a, const T& b) {
  return select(a < b, a, b);
}
template <typename T>
STORMFIELD_LANES_INLINE T larger(const T& a, const T& b) {
  return select(a > b, a, b);
}
template <typename T>
STORMFIELD_LANES_INLINE T absolute(const T& a) {
  return larger(a, -a);
}

STORMFIELD_LANES_INLINE bool negated(bool mask) {
  return !mask;
}
STORMFIELD_LANES_INLINE bool isAny(bool mask) {
  return mask;
}
template <typename Mask>
STORMFIELD_LANES_INLINE Mask negated(const Mask& mask) {
  return ~mask;
}
template <typename Mask>
STORMFIELD_LANES_INLINE Two<Mask> negated(const Two<Mask>& mask) {
  return {~mask.low, ~mask.high};
}
template <typename Mask>
STORMFIELD_LANES_INLINE bool isAny(const Mask& mask) {
#if defined(__AVX2__)
  if constexpr (sizeof(Mask) == 32) return _mm256_movemask_epi8(reinterpret_cast<const __m256i&>(mask)) != 0;
#endif
#if defined(__SSE2__)
  if constexpr (sizeof(Mask) == 16) return _mm_movemask_epi8(reinterpret_cast<const __m128i&>(mask)) != 0;
#endif
}
template <typename Mask>
STORMFIELD_LANES_INLINE bool isAny(const Two<Mask>& mask) {
  return isAny(mask.low | mask.high);
}

// Correctly rounded everywhere.
STORMFIELD_LANES_INLINE float squareRoot(float a) {
  return __builtin_sqrtf(a);
}
STORMFIELD_LANES_INLINE double squareRoot(double a) {
  return __builtin_sqrt(a);
}
STORMFIELD_LANES_INLINE float toFloats(double a) {
  return static_cast<float>(a);
}
STORMFIELD_LANES_INLINE double toDoubles(float a) {
  return static_cast<double>(a);
}
#if defined(__SSE2__)
using Floats16 = Registers<16>::Floats;
using Half16 = Registers<16>::HalfOfDoubles;
STORMFIELD_LANES_INLINE Floats16 squareRoot(const Floats16& a) {
  return _mm_sqrt_ps(a);
}
STORMFIELD_LANES_INLINE Two<Half16> squareRoot(const Two<Half16>& a) {
  return {_mm_sqrt_pd(a.low), _mm_sqrt_pd(a.high)};
}
STORMFIELD_LANES_INLINE Floats16 toFloats(const Two<Half16>& a) {
  return _mm_movelh_ps(_mm_cvtpd_ps(a.low), _mm_cvtpd_ps(a.high));
}
STORMFIELD_LANES_INLINE Two<Half16> toDoubles(const Floats16& a) {
  return {_mm_cvtps_pd(a), _mm_cvtps_pd(_mm_movehl_ps(a, a))};
}
#endif
#if defined(__AVX2__)
using Floats32 = Registers<32>::Floats;
using Half32 = Registers<32>::HalfOfDoubles;
STORMFIELD_LANES_INLINE Floats32 squareRoot(const Floats32& a) {
  return _mm256_sqrt_ps(a);
}
STORMFIELD_LANES_INLINE Two<Half32> squareRoot(const Two<Half32>& a) {
  return {_mm256_sqrt_pd(a.low), _mm256_sqrt_pd(a.high)};
}
STORMFIELD_LANES_INLINE Floats32 toFloats(const Two<Half32>& a) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(a.low)), _mm256_cvtpd_ps(a.high), 1);
}
STORMFIELD_LANES_INLINE Two<Half32> toDoubles(const Floats32& a) {
  return {_mm256_cvtps_pd(_mm256_castps256_ps128(a)), _mm256_cvtps_pd(_mm256_extractf128_ps(a, 1))};
}
#endif

/// The types for a width of a register, and how their lanes are filled and read.
template <int Bytes>
struct Lanes {
  static constexpr int kCount = Bytes / 4;
  using Floats = typename Registers<Bytes>::Floats;
  using Doubles = typename DoublesOf<Bytes>::Type;

  /// get(lane) for all lanes.
  template <typename Get>
  STORMFIELD_LANES_INLINE static Floats floats(const Get& get) {
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return Floats{get(I)...};
    }
    (std::make_integer_sequence<int, kCount>());
  }
  template <typename Get>
  STORMFIELD_LANES_INLINE static Doubles doubles(const Get& get) {
    if constexpr (kCount == 1) {
      return get(0);
    } else {
      using Half = typename Registers<Bytes>::HalfOfDoubles;
      return [&]<int... I>(std::integer_sequence<int, I...>) {
        return Doubles{Half{get(I)...}, Half{get(I + kCount / 2)...}};
      }
      (std::make_integer_sequence<int, kCount / 2>());
    }
  }
  STORMFIELD_LANES_INLINE static Floats all(float a) {
    return floats([a](int) { return a; });
  }
  STORMFIELD_LANES_INLINE static Doubles all(double a) {
    return doubles([a](int) { return a; });
  }
  /// From and to an array.
  STORMFIELD_LANES_INLINE static Doubles load(const double* from) {
    Doubles values;
    __builtin_memcpy(&values, from, sizeof(values));
    return values;
  }
  STORMFIELD_LANES_INLINE static void store(const Doubles& values, double* to) {
    __builtin_memcpy(to, &values, sizeof(values));
  }
};

}  // namespace stormfield::lanes
