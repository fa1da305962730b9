// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What could have shaped the answers beside the clips: the side, the order, haste and inattention.

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/estimate.h"
#include "analysis/tests_2afc.h"

namespace pinchlab::analysis {

/// Was one side of the screen preferred, whatever it showed? Pinch must then be chosen more often
/// where it is on that side. Demonstrations are strata, so that neither a preference for pinch nor
/// sides that are not balanced pass for a side bias.
struct SideBias {
  Counts chosen;  ///< pinch: left chosen, cable: right chosen
  Estimate bias;  ///< share of left choices above one half, were pinch on either side equally often
  Estimate chi_square;   ///< Mantel and Haenszel, no continuity correction
  Estimate p;            ///< of chi_square, df 1, answers taken as independent
  Estimate p_sign_flip;  ///< the same with participants as units
  Counts shown_left;     ///< answers with the pinch clip on the left
  Counts shown_right;
  std::int64_t unknown = 0;  ///< answers whose side was not recorded
};
SideBias side_bias(const AnswersTable& table, std::uint64_t seed);

/// Did the preference change in the course of the session? Position is the rank among the
/// participant's answers, ties among them, though these are in no count.
struct OrderEffect {
  std::vector<Counts> by_position;  ///< [i]: the (i + 1)-th answer of each participant
  Estimate share_by_place;  ///< by which the share of pinch rises from one position to the next:
                            ///< slope of the line of least squares
  Estimate chi_square;  ///< Cochran-Armitage trend of pinch over position, answers as independent
  Estimate p_trend;
  Estimate
      p_sign_flip;  ///< trend within participants; random order makes each one's sign a fair coin
};
OrderEffect order_effect(const AnswersTable& table, std::uint64_t seed);

/// Spread of the reaction times of one set of answers.
struct ReactionTimes {
  std::string name;
  std::int64_t answers = 0;  ///< with a reaction time
  Estimate median_s, lower_quartile_s, upper_quartile_s, shortest_s, longest_s;
};
/// All answers, those for pinch, those for cable, then one row a demonstration.
std::vector<ReactionTimes> reaction_times(const AnswersTable& table, const std::string& pinch_label,
                                          const std::string& cable_label);

/// The share of pinch as a distance on a scale of perceived quality.
struct ScaleValue {
  Estimate bradley_terry_log_odds;  ///< ln(share / (1 - share))
  Estimate thurstone_d;  ///< Thurstone's case V with unit variances: sqrt 2 Phi^-1(share)
  Estimate jod, jod_low, jod_high;  ///< just-objectionable differences: 1 JOD is a share of 3/4
};
/// `low` to `high` is an interval of the share of pinch that is carried over to the JOD.
ScaleValue scale_value(const Counts& counts, const Estimate& low, const Estimate& high);

}  // namespace pinchlab::analysis
