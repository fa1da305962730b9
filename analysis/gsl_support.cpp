// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/gsl_support.h"

#include <gsl/gsl_cdf.h>

#include <cmath>

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

double beta_quantile(double probability, double a, double b) {
  const GslErrorsOff guard;
  double low = 0.0;
  double high = 1.0;
  double x = gsl_cdf_beta_Pinv(probability, a, b);
  if (!(x > 0.0 && x < 1.0)) x = a / (a + b);
  // The distribution function is monotone: a bracket around GSL's answer, then bisection to
  // round-off.
  for (double reach = 1e-6; low == 0.0 || high == 1.0; reach *= 8.0) {
    if (low == 0.0 && x * (1.0 - reach) > 0.0 &&
        gsl_cdf_beta_P(x * (1.0 - reach), a, b) < probability) {
      low = x * (1.0 - reach);
    }
    if (high == 1.0 && x + (1.0 - x) * reach < 1.0 &&
        gsl_cdf_beta_P(x + (1.0 - x) * reach, a, b) > probability) {
      high = x + (1.0 - x) * reach;
    }
    if (reach >= 1.0) break;
  }
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (gsl_cdf_beta_P(middle, a, b) < probability ? low : high) = middle;
  }
}

}  // namespace pinchlab::analysis
