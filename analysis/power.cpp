// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/power.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sf_gamma.h>

#include <algorithm>
#include <cmath>

#include "analysis/binomial.h"
#include "analysis/clustered.h"
#include "analysis/gsl_support.h"
#include "base/counted.h"
#include "base/input_error.h"

namespace pinchlab::analysis {

namespace {

constexpr std::int64_t most_answers = 1000000;

void check(bool good, const char* flag, const char* message) {
  if (!good) throw InputError(flag, message);
}

// The normal approximation, only to know where to begin and how far to look.
double approximate_answers(const PowerQuestion& q) {
  const double z = gsl_cdf_ugaussian_Qinv(q.alpha / 2.0) * 0.5 +
                   gsl_cdf_ugaussian_Pinv(q.power) * std::sqrt(q.share * (1.0 - q.share));
  return std::pow(z / (q.share - 0.5), 2.0);
}

constexpr int simulated_studies = 4000;

// The smallest number of participants with which the sign-flip test has the power, by halving the
// interval between a number that has not and one that has.
void find_participants(const PowerQuestion& question, PowerAnswer& answer) {
  const auto power = [&](std::int64_t n) {
    return sign_flip_power(n, question, simulated_studies, 1);
  };
  std::int64_t high = std::max<std::int64_t>(1, answer.participants);
  while ((answer.power = power(high)) < question.power) high *= 2;
  std::int64_t low = high / 2;
  while (low > 0 && power(low) >= question.power) low /= 2;
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    const double reached = power(middle);
    if (reached >= question.power) answer.power = reached;
    (reached >= question.power ? high : low) = middle;
  }
  answer.participants = high;
  answer.power = power(high);
  answer.studies = simulated_studies;
}

}  // namespace

void check_question(const PowerQuestion& q) {
  check(q.share > 0.0 && q.share < 1.0, "--share", "must be above 0 and below 1");
  check(q.share != 0.5, "--share",
        "one half is what the test takes for granted; no number of participants "
        "shows it to be otherwise");
  check(q.alpha > 0.0 && q.alpha < 1.0, "--alpha", "must be above 0 and below 1");
  check(q.power > q.alpha && q.power < 1.0, "--power", "must be between alpha and 1");
  check(q.trials >= 1 && q.trials <= 1000, "--trials", "must be from 1 to 1000");
  check(q.icc >= 0.0 && q.icc <= 1.0, "--icc", "must be from 0 to 1");
}

std::vector<double> answers_of_one(const PowerQuestion& q) {
  const auto n = static_cast<unsigned>(q.trials);
  std::vector<double> probability(n + 1U, 0.0);
  if (q.icc >= 1.0) {
    probability.front() = 1.0 - q.share;
    probability.back() = q.share;
    return probability;
  }
  const double scale = q.icc > 0.0 ? 1.0 / q.icc - 1.0 : 0.0;
  const double a = q.share * scale, b = (1.0 - q.share) * scale;
  for (unsigned k = 0; k <= n; ++k) {
    probability[k] = q.icc > 0.0 ? std::exp(gsl_sf_lnchoose(n, k) +
                                            gsl_sf_lnbeta(a + k, b + n - k) - gsl_sf_lnbeta(a, b))
                                 : gsl_ran_binomial_pdf(k, q.share, n);
  }
  return probability;
}

// Many participants: the sum of flipped scores is normal (with a continuity correction: it moves in
// steps of 2).
bool sign_flips_reject(const std::vector<unsigned>& drawn, std::int64_t participants,
                       double alpha) {
  const auto trials = static_cast<std::int64_t>(drawn.size()) - 1;
  const bool exact = participants <= 20 || participants * participants * trials <= 100000;
  std::vector<std::int64_t> scores;
  double sum = 0.0, squares = 0.0;
  for (std::int64_t k = 0; k <= trials; ++k) {
    const std::int64_t score = 2 * k - trials;
    const unsigned count = drawn[static_cast<size_t>(k)];
    if (exact) scores.insert(scores.end(), count, score);
    sum += static_cast<double>(score) * count;
    squares += static_cast<double>(score * score) * count;
  }
  if (exact) return sign_flip_test(std::move(scores), RandomUse::power, 0).p.value <= alpha;
  const double away = std::max(0.0, std::abs(sum) - 1.0);
  return 2.0 * gsl_cdf_ugaussian_Q(away / std::sqrt(squares)) <= alpha;
}

double sign_flip_power(std::int64_t participants, const PowerQuestion& question, int studies,
                       std::uint64_t seed) {
  const GslErrorsOff guard;
  const std::vector<double> probability = answers_of_one(question);
  const Rng rng = make_rng(RandomUse::power, seed, static_cast<std::uint64_t>(participants));
  std::vector<unsigned> drawn(probability.size());
  int found = 0;
  for (int study = 0; study < studies; ++study) {
    gsl_ran_multinomial(rng.get(), probability.size(), static_cast<unsigned>(participants),
                        probability.data(), drawn.data());
    found += sign_flips_reject(drawn, participants, question.alpha) ? 1 : 0;
  }
  return static_cast<double>(found) / studies;
}

ExactTest exact_test(std::int64_t answers, double share, double alpha) {
  const GslErrorsOff guard;
  // The critical count is close to its normal approximation; walk from there.
  const auto n = static_cast<double>(answers);
  auto critical =
      static_cast<std::int64_t>(n / 2.0 + gsl_cdf_ugaussian_Qinv(alpha / 2.0) * std::sqrt(n) / 2.0);
  critical = std::clamp(critical, answers / 2 + 1, answers + 1);
  while (critical > answers / 2 + 1 &&
         2.0 * binomial_upper_tail(critical - 1, 0.5, answers) <= alpha)
    --critical;
  while (critical <= answers && 2.0 * binomial_upper_tail(critical, 0.5, answers) > alpha)
    ++critical;
  ExactTest test;
  test.answers = answers;
  test.critical = critical;
  test.size = 2.0 * binomial_upper_tail(critical, 0.5, answers);
  // Both tails count as rejections; the wrong one adds next to nothing.
  test.power = binomial_upper_tail(critical, share, answers) +
               binomial_upper_tail(critical, 1.0 - share, answers);
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
  answer.participants = static_cast<std::int64_t>(std::ceil(
      static_cast<double>(answer.safe.answers) * answer.design_effect / question.trials - 1e-9));
  answer.power = answer.safe.power;
  if (question.trials > 1) find_participants(question, answer);
  return answer;
}

std::string power_text(const PowerQuestion& question, const PowerAnswer& answer) {
  const auto line = [](const char* what, const ExactTest& test) {
    return fmt::format(
        "  {}: {}; rejects from {} of {} on, false-positive rate {:.4f}, power {:.4f}\n", what,
        counted(test.answers, "answer"), test.critical, test.answers, test.size, test.power);
  };
  std::string text =
      fmt::format("{} {} needed to find a share of {} with power {} ({}, two-sided, alpha {}).\n",
                  counted(answer.participants, "participant"),
                  answer.participants == 1 ? "is" : "are", question.share, question.power,
                  question.trials > 1 ? "sign-flip test over participants" : "exact binomial test",
                  question.alpha);
  if (question.trials > 1) {
    text += fmt::format(
        "Each participant gives {} answers with an intraclass correlation of {} (design effect "
        "{:.4g});\nin {} simulated studies with {} the test found it in {:.1f} %.\n",
        question.trials, question.icc, answer.design_effect, answer.studies,
        counted(answer.participants, "participant"), 100.0 * answer.power);
  }
  text += "Independent answers, one a participant (exact binomial test):\n";
  text += line("safe (every larger number reaches the power too)", answer.safe);
  text += line("first number that reaches it", answer.first);
  return text;
}

}  // namespace pinchlab::analysis
