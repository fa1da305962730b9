// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tests and intervals for two-alternative forced choice: how often was pinch chosen, and is that
// more than the half that chance gives? README.md gives every formula and its source.

#include <span>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/estimate.h"

namespace pinchlab::analysis {

struct Interval {
  double low = 0.0;
  double high = 1.0;
};

/// Goodness of fit to one half each: X^2 = (pinch - cable)^2 / n, without continuity correction
/// (the thesis' test, 3.3.2).
double chi_square_half(const Counts& counts);

/// Upper tail of the chi-square distribution with `df` degrees of freedom.
double chi_square_p(double chi_square, double df);

/// Two-sided exact binomial p against one half: twice the smaller tail, at most 1.
double exact_binomial_p(const Counts& counts);

/// Wilson's score interval for the share of pinch, no continuity correction. `alpha` in (0, 1).
/// Like Clopper and Pearson's it begins at exactly 0 where nobody chose pinch, and ends at exactly
/// 1 where all did.
Interval wilson_interval(const Counts& counts, double alpha);

/// Clopper and Pearson's exact interval for the share of pinch.
Interval clopper_pearson_interval(const Counts& counts, double alpha);

/// Cohen's h = 2 asin sqrt(share) - 2 asin sqrt(1/2): 0.2 small, 0.5 medium, 0.8 large.
double cohens_h(const Counts& counts);

/// Natural logarithm of the Bayes factor of "share ~ Beta(1, 1)" (uniform) against "share = 1/2":
/// ln [B(pinch + 1, cable + 1) 2^n].
double log_bayes_factor(const Counts& counts);

/// Holm's step-down adjustment of a family of p-values (strong control of any false positive).
std::vector<double> holm(std::span<const double> p);

/// Benjamini and Hochberg's step-up adjustment (false discovery rate).
std::vector<double> benjamini_hochberg(std::span<const double> p);

/// Does the share differ between demonstrations? Pearson's X^2 of the K x 2 table, which takes all
/// answers as independent.
struct Heterogeneity {
  Estimate chi_square;
  Estimate df;
  Estimate p;
};
Heterogeneity heterogeneity(std::span<const Counts> counts);

/// The test and the interval of a share that a reader should go by, and which they are. Where
/// participants answered more than once the participant is the unit.
struct Reading {
  Estimate p;                 ///< two-sided, of one half
  Estimate p_holm{}, p_bh{};  ///< over the rows tested together
  std::string test;           ///< in words
  Estimate low, high;         ///< of the share
  std::string interval;       ///< in words
};

/// Everything that is said of one row of counts: a demonstration's, or a group's sum.
struct Row {
  std::string name;
  Counts counts;
  double share = 0.0;
  Reading read;
  /// Not empty: why its answers are not independent, so that what follows but cohens_h must not be
  /// read as a test or an interval.
  std::string why_not_independent;
  double chi_square = 0.0;
  double p_chi_square = 1.0;
  double p_exact = 1.0;
  Interval wilson;
  Interval clopper_pearson;
  double cohens_h = 0.0;
  double log_bayes_factor = 0.0;
  double p_holm = 1.0;  ///< of p_chi_square, over the rows tested together
  double p_bh = 1.0;
};

/// Computes all but what is read and the adjusted p-values. counts.total() must be positive.
Row make_row(const std::string& name, const Counts& counts, double alpha);

/// Adjusts the chi-square p-values and those that are read of rows that are tested together.
void adjust_family(std::span<Row*> rows);

}  // namespace pinchlab::analysis
