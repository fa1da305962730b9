// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Preferences in seven grades (comparison scale of ITU-R BT.500), participant by participant.

#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/estimate.h"

namespace pinchlab::analysis {

/// Wilcoxon's signed-rank test of a median of 0, two-sided; zeros are dropped, equal sizes share
/// their ranks.
struct SignedRank {
  std::size_t positive = 0, negative = 0, zeros = 0;
  double w_plus = 0.0;    ///< sum of the ranks of positive scores
  bool is_exact = false;  ///< by the distribution over all signs; from 301 scores on by the normal
  Estimate p;             ///< none without a score other than 0
  Estimate p_sign;        ///< sign test: exact, binomial, of positive against negative
};
SignedRank signed_rank_test(const std::vector<double>& scores);

/// Grades of a demonstration or a group, -3 to 3, positive for the method under test.
struct GradedPreference {
  std::string name;
  std::size_t answers = 0, ties = 0, participants = 0;
  double mean = 0.0;  ///< of the participants' means
  SignedRank test;    ///< of the participants' means
  Estimate p_holm;    ///< of test.p over the demonstrations; none for groups
};

/// Demonstrations, then groups; empty where preferences were not graded.
std::vector<GradedPreference> graded_preferences(const AnswersTable& table);

}  // namespace pinchlab::analysis
