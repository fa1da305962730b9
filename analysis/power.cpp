// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/power.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

#include "analysis/gsl_support.h"
#include "base/input_error.h"

namespace pinchlab::analysis {

namespace {

constexpr std::int64_t most_answers = 1000000;

// P(X >= k), X ~ Binomial(n, p).
double upper_tail(std::int64_t k, double p, std::int64_t n) {
  if (k <= 0) return 1.0;
  if (k > n) return 0.0;
  return gsl_cdf_binomial_Q(static_cast<unsigned>(k - 1), p, static_cast<unsigned>(n));
}

void check(bool good, const char* flag, const char* message) {
  if (!good) throw InputError(flag, message);
}

void check_question(const PowerQuestion& q) {
  check(q.share > 0.0 && q.share < 1.0, "--share", "must be between 0 and 1");
  check(q.share != 0.5, "--share",
        "one half is what the test takes for granted; no number of participants "
        "shows it to be otherwise");
  check(q.alpha > 0.0 && q.alpha < 1.0, "--alpha", "must be between 0 and 1");
  check(q.power > q.alpha && q.power < 1.0, "--power", "must be between alpha and 1");
  check(q.trials >= 1 && q.trials <= 1000, "--trials", "must be from 1 to 1000");
  check(q.icc >= 0.0 && q.icc <= 1.0, "--icc", "must be from 0 to 1");
}

// The normal approximation, only to know where to begin and how far to look.
double approximate_answers(const PowerQuestion& q) {
  const double z = gsl_cdf_ugaussian_Qinv(q.alpha / 2.0) * 0.5 +
                   gsl_cdf_ugaussian_Pinv(q.power) * std::sqrt(q.share * (1.0 - q.share));
  return std::pow(z / (q.share - 0.5), 2.0);
}

}  // namespace

ExactTest exact_test(std::int64_t answers, double share, double alpha) {
  const GslErrorsOff guard;
  // The critical count is close to its normal approximation; walk from there.
  const auto n = static_cast<double>(answers);
  auto critical =
      static_cast<std::int64_t>(n / 2.0 + gsl_cdf_ugaussian_Qinv(alpha / 2.0) * std::sqrt(n) / 2.0);
  critical = std::clamp(critical, answers / 2 + 1, answers + 1);
  while (critical > answers / 2 + 1 && 2.0 * upper_tail(critical - 1, 0.5, answers) <= alpha)
    --critical;
  while (critical <= answers && 2.0 * upper_tail(critical, 0.5, answers) > alpha) ++critical;
  ExactTest test;
  test.answers = answers;
  test.critical = critical;
  test.size = 2.0 * upper_tail(critical, 0.5, answers);
  // Both tails count as rejections; the wrong one adds next to nothing.
  test.power = upper_tail(critical, share, answers) + upper_tail(critical, 1.0 - share, answers);
  return test;
}

PowerAnswer participants_needed(const PowerQuestion& question) {
  check_question(question);
  const double about = approximate_answers(question);
  const auto too_many = [] {
    return InputError("--share",
                      "so close to one half that more than 1000000 answers are needed; ask for a "
                      "larger difference");
  };
  if (!(2.0 * about + 100.0 < static_cast<double>(most_answers))) throw too_many();

  // Power rises like a saw with the number of answers: go through all of them up to where the saw's
  // lower edge is safely above what is asked for.
  PowerAnswer answer;
  const auto from = about < 10000.0 ? 1 : static_cast<std::int64_t>(0.5 * about);
  const auto to = static_cast<std::int64_t>(2.0 * about) + 100;
  for (std::int64_t n = from; n <= to; ++n) {
    const ExactTest test = exact_test(n, question.share, question.alpha);
    if (test.power < question.power) {
      answer.safe = ExactTest{};
      continue;
    }
    if (answer.first.answers == 0) answer.first = test;
    if (answer.safe.answers == 0) answer.safe = test;
  }
  if (answer.safe.answers == 0) throw too_many();
  answer.design_effect = 1.0 + (question.trials - 1) * question.icc;
  const auto participants = [&](std::int64_t answers) {
    return static_cast<std::int64_t>(
        std::ceil(static_cast<double>(answers) * answer.design_effect / question.trials - 1e-9));
  };
  answer.participants = participants(answer.safe.answers);
  answer.participants_first = participants(answer.first.answers);
  return answer;
}

std::string power_text(const PowerQuestion& question, const PowerAnswer& answer) {
  const auto line = [](const char* what, const ExactTest& test) {
    return fmt::format(
        "  {}: {} answers; rejects from {} of {} on, false-positive rate {:.4f}, power {:.4f}\n",
        what, test.answers, test.critical, test.answers, test.size, test.power);
  };
  std::string text = fmt::format(
      "{} participants are needed to find a share of {} with power {} (two-sided exact binomial "
      "test, alpha {}).\n",
      answer.participants, question.share, question.power, question.alpha);
  text += "Independent answers:\n";
  text += line("safe (every larger number reaches the power too)", answer.safe);
  text += line("first number that reaches it", answer.first);
  if (question.trials > 1) {
    text += fmt::format(
        "Each participant gives {} answers with an intraclass correlation of {}: design effect "
        "{:.4g},\n"
        "so {} answers of {} participants count as {} independent ones.\n",
        question.trials, question.icc, answer.design_effect, answer.participants * question.trials,
        answer.participants, answer.safe.answers);
  }
  return text;
}

}  // namespace pinchlab::analysis
