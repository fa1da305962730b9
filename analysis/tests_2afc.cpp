// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/tests_2afc.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_sf_gamma.h>

#include <algorithm>
#include <cassert>
#include <numeric>

#include "analysis/binomial.h"
#include "analysis/gsl_support.h"

namespace pinchlab::analysis {

double chi_square_half(const Counts& counts) {
  const auto difference = static_cast<double>(counts.pinch - counts.cable);
  return difference * difference / static_cast<double>(counts.total());
}

double chi_square_p(double chi_square, double df) {
  const GslErrorsOff guard;
  return gsl_cdf_chisq_Q(chi_square, df);
}

double exact_binomial_p(const Counts& counts) {
  const std::int64_t larger = std::max(counts.pinch, counts.cable);
  return std::min(1.0, 2.0 * binomial_upper_tail(larger, 0.5, counts.total()));
}

namespace {

/// From the lower bound at any counts: the upper bound is that of the other method's. Both are 1
/// less a number, so that swapping the methods mirrors them to the bit.
template <class Lower>
Interval mirrored_interval(const Counts& counts, const Lower& lower) {
  const double low = lower(static_cast<double>(counts.pinch), static_cast<double>(counts.cable));
  const double rest = lower(static_cast<double>(counts.cable), static_cast<double>(counts.pinch));
  return {1.0 - (1.0 - low), 1.0 - rest};
}

}  // namespace

Interval wilson_interval(const Counts& counts, double alpha) {
  const double z = gsl_cdf_ugaussian_Qinv(alpha / 2.0);
  // The lesser root of (n + z^2) p^2 - (2 k + z^2) p + k^2 / n = 0 by the greater: no difference of
  // near numbers, and exactly 0 at k = 0.
  return mirrored_interval(counts, [z](double k, double rest) {
    const double n = k + rest;
    return k * k / n / (k + z * z / 2.0 + z * std::sqrt(k * rest / n + z * z / 4.0));
  });
}

Interval clopper_pearson_interval(const Counts& counts, double alpha) {
  // A bound p solves "the tail at k has probability alpha/2"; tails of the binomial are those of a
  // beta.
  return mirrored_interval(counts, [alpha](double k, double rest) {
    return k == 0.0 ? 0.0 : beta_quantile(alpha / 2.0, k, rest + 1.0);
  });
}

double cohens_h(const Counts& counts) {
  // 2 asin sqrt(p) - pi/2 = asin(2 p - 1)
  return std::asin(static_cast<double>(counts.pinch - counts.cable) /
                   static_cast<double>(counts.total()));
}

double log_bayes_factor(const Counts& counts) {
  const auto k = static_cast<double>(counts.pinch);
  const auto rest = static_cast<double>(counts.cable);
  return gsl_sf_lnbeta(k + 1.0, rest + 1.0) + (k + rest) * M_LN2;
}

namespace {

std::vector<size_t> increasing(std::span<const double> p) {
  std::vector<size_t> order(p.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return p[a] < p[b]; });
  return order;
}

}  // namespace

std::vector<double> holm(std::span<const double> p) {
  const std::vector<size_t> order = increasing(p);
  std::vector<double> adjusted(p.size());
  double running = 0.0;
  for (size_t rank = 0; rank < order.size(); ++rank) {
    const double scaled = p[order[rank]] * static_cast<double>(p.size() - rank);
    running = std::max(running, std::min(1.0, scaled));
    adjusted[order[rank]] = running;
  }
  return adjusted;
}

std::vector<double> benjamini_hochberg(std::span<const double> p) {
  const std::vector<size_t> order = increasing(p);
  std::vector<double> adjusted(p.size());
  double running = 1.0;
  for (size_t rank = order.size(); rank-- > 0;) {
    const double scaled =
        p[order[rank]] * static_cast<double>(p.size()) / static_cast<double>(rank + 1);
    running = std::min(running, scaled);
    adjusted[order[rank]] = running;
  }
  return adjusted;
}

Heterogeneity heterogeneity(std::span<const Counts> counts) {
  Counts sum;
  for (const Counts& row : counts) sum.pinch += row.pinch, sum.cable += row.cable;
  Heterogeneity result;
  const char* reason = counts.size() < 2 ? "one demonstration cannot differ from itself"
                       : sum.pinch == 0 || sum.cable == 0
                           ? "every answer is the same, so demonstrations cannot be compared"
                           : nullptr;
  if (reason) {
    result.chi_square = result.df = result.p = Estimate::none(reason);
    return result;
  }
  const double p = static_cast<double>(sum.pinch) / static_cast<double>(sum.total());
  double chi_square = 0.0;
  for (const Counts& row : counts) {
    const double surplus = static_cast<double>(row.pinch) - static_cast<double>(row.total()) * p;
    chi_square += surplus * surplus / (static_cast<double>(row.total()) * p * (1.0 - p));
  }
  const auto df = static_cast<double>(counts.size() - 1);
  result.chi_square = chi_square;
  result.df = df;
  result.p = chi_square_p(chi_square, df);
  return result;
}

Row make_row(const std::string& name, const Counts& counts, double alpha) {
  assert(counts.total() > 0);
  Row row;
  row.name = name;
  row.counts = counts;
  row.share = static_cast<double>(counts.pinch) / static_cast<double>(counts.total());
  row.chi_square = chi_square_half(counts);
  row.p_chi_square = chi_square_p(row.chi_square, 1.0);
  row.p_exact = exact_binomial_p(counts);
  row.wilson = wilson_interval(counts, alpha);
  row.clopper_pearson = clopper_pearson_interval(counts, alpha);
  row.cohens_h = cohens_h(counts);
  row.log_bayes_factor = log_bayes_factor(counts);
  return row;
}

void adjust_family(std::span<Row*> rows) {
  std::vector<double> p, read;
  for (const Row* row : rows) {
    p.push_back(row->p_chi_square);
    read.push_back(row->read.p ? row->read.p.value : 1.0);
  }
  const std::vector<double> by_holm = holm(p), read_by_holm = holm(read);
  const std::vector<double> by_bh = benjamini_hochberg(p), read_by_bh = benjamini_hochberg(read);
  for (size_t i = 0; i < rows.size(); ++i) {
    rows[i]->p_holm = by_holm[i];
    rows[i]->p_bh = by_bh[i];
    Reading& reading = rows[i]->read;
    reading.p_holm = reading.p ? Estimate(read_by_holm[i]) : reading.p;
    reading.p_bh = reading.p ? Estimate(read_by_bh[i]) : reading.p;
  }
}

}  // namespace pinchlab::analysis
