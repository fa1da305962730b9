// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How many participants does a study need for the test that its report is read by: the exact
// binomial test where each participant answers once, sign flips over participants otherwise.

#include <cstdint>
#include <string>
#include <vector>

namespace pinchlab::analysis {

/// The two-sided exact binomial test of one half with `answers` answers: it rejects from `critical`
/// choices of one method on.
struct ExactTest {
  std::int64_t answers = 0;
  std::int64_t critical = 0;  ///< answers + 1: it never rejects
  double size = 0.0;          ///< its true false-positive rate, at most alpha
  double power = 0.0;         ///< at the share asked for
};
ExactTest exact_test(std::int64_t answers, double share, double alpha);

struct PowerQuestion {
  double share = 0.0;   ///< true share of pinch, in (0, 1) but not 1/2
  double alpha = 0.05;  ///< in (0, 1)
  double power = 0.8;   ///< wanted, in (alpha, 1)
  int trials = 1;       ///< answers that each participant gives, 1 .. 1000
  double icc = 0.0;     ///< intraclass correlation of one participant's answers, 0 .. 1
};

/// Power of the sign-flip test over `participants` who each give question.trials answers (that
/// agree as question.icc says: beta-binomial), from `studies` simulated studies.
double sign_flip_power(std::int64_t participants, const PowerQuestion& question, int studies,
                       std::uint64_t seed);

/// Throws InputError for a question out of range.
void check_question(const PowerQuestion& question);

/// Probability of k choices of one method among the answers of one participant, k = 0 .. trials:
/// beta-binomial.
std::vector<double> answers_of_one(const PowerQuestion& question);

/// Does the sign-flip test find a preference at this level? drawn[k] participants chose one method
/// k times.
bool sign_flips_reject(const std::vector<unsigned>& drawn, std::int64_t participants, double alpha);

struct PowerAnswer {
  ExactTest first;  ///< the smallest number of independent answers that reaches the power
  ExactTest safe;   ///< the smallest from which no larger number falls below it again
  double design_effect = 1.0;     ///< 1 + (trials - 1) icc (Kish)
  std::int64_t participants = 0;  ///< that the test needs: `safe`, or simulated if trials > 1
  double power = 0.0;             ///< of the test with that many
  int studies = 0;                ///< simulated for each number of participants; 0: none needed
};

/// Throws InputError for a question out of range or one that needs more than 1000000 answers.
PowerAnswer participants_needed(const PowerQuestion& question);

/// The answer in words, as `pinchlab power` prints it.
std::string power_text(const PowerQuestion& question, const PowerAnswer& answer);

}  // namespace pinchlab::analysis
