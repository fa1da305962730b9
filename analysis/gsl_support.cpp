// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/gsl_support.h"

namespace pinchlab::analysis {

namespace {

// The finalising mix of SplitMix64 (Steele, Lea and Flood 2014): close inputs give unrelated
// outputs.
std::uint64_t mix(std::uint64_t value) {
  value += 0x9E3779B97F4A7C15U;
  value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9U;
  value = (value ^ (value >> 27U)) * 0x94D049BB133111EBU;
  return value ^ (value >> 31U);
}

}  // namespace

Rng make_rng(RandomUse use, std::uint64_t seed, std::uint64_t index) {
  Rng rng(gsl_rng_alloc(gsl_rng_mt19937));
  const std::uint64_t word = mix(mix(mix(seed) + static_cast<std::uint64_t>(use)) + index);
  // mt19937 takes 32 bits of seed; 0 would stand for its default.
  gsl_rng_set(rng.get(), static_cast<unsigned long>(word & 0xFFFFFFFFU));
  return rng;
}

}  // namespace pinchlab::analysis
