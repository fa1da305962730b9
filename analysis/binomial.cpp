// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/binomial.h"

#include <gsl/gsl_sf_gamma.h>

#include <algorithm>
#include <cmath>

#include "analysis/gsl_support.h"

namespace pinchlab::analysis {

namespace {

// x ln(x / mean) + mean - x, without the cancellation that the terms suffer near x = mean.
double deviance_part(double x, double mean) {
  const double e = (x - mean) / mean;
  return mean * ((1.0 + e) * std::log1p(e) - e);
}

// x^a y^b / (a B(a, b)) with y = 1 - x, as Loader (2000, Fast and accurate computation of binomial
// probabilities) writes it: no difference of large logarithms.
double prefactor(double x, double y, double a, double b) {
  const double n = a + b;
  const double stirling = gsl_sf_gammastar(n) / (gsl_sf_gammastar(a) * gsl_sf_gammastar(b));
  return stirling * std::exp(-deviance_part(a, n * x) - deviance_part(b, n * y)) *
         std::sqrt(b / (2.0 * M_PI * a * n));
}

// The continued fraction of I_x(a, b) (DLMF 8.17.22) by Lentz's method as Thompson and Barnett
// modified it. Converges in O(sqrt(max(a, b))) terms for x below (a + 1) / (a + b + 2).
double continued_fraction(double x, double a, double b) {
  constexpr double tiny = 1e-300;
  const auto away_from_0 = [](double value) { return std::abs(value) < tiny ? tiny : value; };
  double c = 1.0;
  double d = 1.0 / away_from_0(1.0 - (a + b) * x / (a + 1.0));
  double fraction = d;
  for (int term_pair = 1; term_pair < 10'000'000; ++term_pair) {
    const double m = term_pair;
    for (const double term : {m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
                              -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))}) {
      d = 1.0 / away_from_0(1.0 + term * d);
      c = away_from_0(1.0 + term / c);
      fraction *= c * d;
    }
    if (std::abs(c * d - 1.0) < 1e-15) break;
  }
  return fraction;
}

// P(X <= x) with y = 1 - x given, so that neither tail loses digits.
double beta_tail(double x, double y, double a, double b) {
  if (x <= 0.0) return 0.0;
  if (y <= 0.0) return 1.0;
  if (x < (a + 1.0) / (a + b + 2.0)) return prefactor(x, y, a, b) * continued_fraction(x, a, b);
  return 1.0 - prefactor(y, x, b, a) * continued_fraction(y, b, a);
}

}  // namespace

double beta_cdf(double x, double a, double b) {
  const GslErrorsOff guard;
  return beta_tail(x, 1.0 - x, a, b);
}

double beta_quantile(double probability, double a, double b) {
  const GslErrorsOff guard;
  double low = 0.0;
  double high = 1.0;
  double x = a / (a + b);
  // Newton's method inside a bracket that every value narrows; halving where it leaves it.
  for (int iteration = 0; iteration < 2000; ++iteration) {
    const double excess = beta_tail(x, 1.0 - x, a, b) - probability;
    (excess < 0.0 ? low : high) = x;
    const double density = prefactor(x, 1.0 - x, a, b) * a / (x * (1.0 - x));
    double next = x - excess / density;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == x || next <= low || next >= high || std::abs(next - x) < 1e-16 * x) return next;
    x = next;
  }
  return x;
}

double binomial_upper_tail(std::int64_t k, double p, std::int64_t n) {
  if (k <= 0) return 1.0;
  if (k > n) return 0.0;
  return std::min(1.0, beta_cdf(p, static_cast<double>(k), static_cast<double>(n - k) + 1.0));
}

}  // namespace pinchlab::analysis
