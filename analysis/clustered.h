// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pooling the answers of several demonstrations. The answers of one participant resemble each
// other, so the participant is the unit: tests that count answers as independent claim too much (or
// too little).

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/estimate.h"
#include "analysis/gsl_support.h"

namespace pinchlab::analysis {

/// The answers of one participant to the demonstrations that are pooled.
struct Cluster {
  int answers = 0;  ///< > 0
  int pinch = 0;    ///< of them, for pinch
  std::strong_ordering operator<=>(const Cluster&) const =
      default;  // NOLINT(modernize-use-nullptr)
};

/// The clusters of a group, one a participant with at least one answer in it.
std::vector<Cluster> clusters_of(const AnswersTable& table, const Group& group);

/// Rao and Scott's first-order correction with participants as clusters.
struct RaoScott {
  Estimate variance;       ///< of the pooled share p: N/(N-1) sum (y_i - n_i p)^2 / (sum n_i)^2
  Estimate design_effect;  ///< variance / (p (1 - p) / n)
  Estimate icc;            ///< intraclass correlation, (design_effect - 1) / (mean n_i - 1)
  Estimate chi_square;     ///< naive X^2 / design_effect
  Estimate p;              ///< against chi-square, df 1
  Estimate p_f;            ///< against F(1, N - 1), which allows for few participants
};
RaoScott rao_scott(std::span<const Cluster> clusters);

/// Two-sided p of |sum of scores| when the sign of each participant's score is a fair coin's, in
/// exact integers. Exact (all sign patterns, by convolution) up to a cost of 1e8, beyond by 99999
/// random flips.
struct SignFlip {
  Estimate p;
  bool exact = true;
};
SignFlip sign_flip_test(std::vector<std::int64_t> scores, RandomUse use, std::uint64_t seed);

/// The score of each cluster for the pooled test: pinch minus cable answers.
std::vector<std::int64_t> preference_scores(std::span<const Cluster> clusters);

/// Studentised (bootstrap-t) resampling of whole participants.
struct ClusterBootstrap {
  Estimate low, high;  ///< symmetric interval of the pooled share, cut to [0, 1]
  Estimate p;          ///< two-sided, of share 1/2; agrees with the interval
  int resamples = 0;
};
ClusterBootstrap cluster_bootstrap(std::span<const Cluster> clusters, double alpha, int resamples,
                                   gsl_rng* rng);

/// Cochran's Q: do the demonstrations differ, within participants? A participant's score of a
/// demonstration is the number of answers for pinch, 0 or 1 in Cochran's own case; under the
/// hypothesis the scores of a participant can be exchanged. Participants with gaps are left out.
struct CochranQ {
  Estimate q;
  Estimate df;
  Estimate p;
  int participants = 0;  ///< that were complete
};
CochranQ cochran_q(const AnswersTable& table, const Group& group);

/// The pooled test of one group, naive and corrected.
struct Pooled {
  Estimate chi_square;  ///< of the summed counts, as if all answers were independent
  Estimate p_naive;
  int participants = 0;
  RaoScott rao_scott;
  SignFlip sign_flip;
  ClusterBootstrap bootstrap;
};
Pooled pooled_tests(const AnswersTable& table, const Group& group, double alpha, int resamples,
                    std::uint64_t seed);

}  // namespace pinchlab::analysis
