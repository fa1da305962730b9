// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tails of the binomial distribution and quantiles of the beta distribution for any counts. GSL's
// own give up (NaN, and an inverse that never ends) from about 500,000 answers on.

#include <cstdint>

namespace pinchlab::analysis {

/// P(X <= x), X ~ Beta(a, b); a and b positive, up to 4e9. Relative error of a tail below 1e-10.
double beta_cdf(double x, double a, double b);

/// The x with beta_cdf(x, a, b) = probability, which is in (0, 1).
double beta_quantile(double probability, double a, double b);

/// P(X >= k), X ~ Binomial(n, p); p in [0, 1], n >= 0.
double binomial_upper_tail(std::int64_t k, double p, std::int64_t n);

}  // namespace pinchlab::analysis
