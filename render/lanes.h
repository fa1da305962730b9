// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Several pixels at a time, by the vector types of GCC and Clang. Every operation is exact to the
// last digit as IEEE 754 says, one pixel by itself: what is drawn is the same on any processor.

#include <cmath>
#include <cstdint>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace pinchlab {

constexpr int lane_count = 4;
using Lanes = float __attribute__((vector_size(4 * lane_count)));
using Mask = std::int32_t __attribute__((vector_size(4 * lane_count)));

// What is written for one number or for lanes.
inline float least(float a, float b) {
  return a < b ? a : b;
}
inline float most(float a, float b) {
  return a > b ? a : b;
}
inline float square_root(float value) {
  return std::sqrt(value);
}

inline Lanes splat(float value) {
  return Lanes{value, value, value, value};
}
inline Lanes least(Lanes a, Lanes b) {
  return a < b ? a : b;
}
inline Lanes most(Lanes a, Lanes b) {
  return a > b ? a : b;
}
template <typename Value>
Value magnitude(Value value) {
  return most(value, -value);
}
inline Lanes only(Mask where, Lanes value) {
  return where ? value : Lanes{};
}

inline Lanes square_root(Lanes value) {
#if defined(__SSE2__)
  return _mm_sqrt_ps(value);
#else
  for (int i = 0; i < lane_count; ++i) value[i] = std::sqrt(value[i]);
  return value;
#endif
}

/// Whole numbers at most as large as these, which are within 1e9 of zero.
inline Lanes floor_of(Lanes value) {
  const Lanes whole = __builtin_convertvector(__builtin_convertvector(value, Mask), Lanes);
  return whole > value ? whole - 1.0f : whole;
}

inline bool any(Mask where) {
#if defined(__SSE2__)
  return _mm_movemask_ps(reinterpret_cast<__m128>(where)) != 0;
#else
  for (int i = 0; i < lane_count; ++i) {
    if (where[i] != 0) return true;
  }
  return false;
#endif
}

}  // namespace pinchlab
