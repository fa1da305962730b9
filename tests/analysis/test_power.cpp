// SPDX-License-Identifier: GPL-3.0-or-later
#include <gsl/gsl_randist.h>

#include <cmath>

#include "analysis/power.h"
#include "analysis/size_study.h"
#include "analysis/tests_2afc.h"
#include "base/input_error.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

double binomial(std::int64_t n, std::int64_t k, double p) {
  const auto x = static_cast<double>(n);
  const auto y = static_cast<double>(k);
  return std::exp(std::lgamma(x + 1) - std::lgamma(y + 1) - std::lgamma(x - y + 1) +
                  y * std::log(p) + (x - y) * std::log(1 - p));
}

// Size and power are sums over the counts that the exact test rejects.
TEST(ExactTest, IsTheTestOfTheReport) {
  for (std::int64_t n = 1; n <= 80; ++n) {
    const ExactTest test = exact_test(n, 0.7, 0.05);
    double size = 0.0, power = 0.0;
    for (std::int64_t k = 0; k <= n; ++k) {
      if (exact_binomial_p({k, n - k}) > 0.05) continue;
      size += binomial(n, k, 0.5);
      power += binomial(n, k, 0.7);
    }
    EXPECT_NEAR(test.size, size, 1e-9) << n;
    EXPECT_NEAR(test.power, power, 1e-9) << n;
    EXPECT_LE(test.size, 0.05);
  }
  EXPECT_EQ(exact_test(16, 0.75, 0.05).critical, 13);  // 12 of 16 has an exact p of 0.0768
}

TEST(Power, NumbersAreTheSmallest) {
  for (double share : {0.6, 0.7, 0.75, 0.9, 0.25}) {
    PowerQuestion question;
    question.share = share;
    const PowerAnswer answer = participants_needed(question);
    for (std::int64_t n = 1; n < answer.first.answers; ++n)
      EXPECT_LT(exact_test(n, share, 0.05).power, 0.8);
    EXPECT_GE(answer.first.power, 0.8);
    EXPECT_LT(exact_test(answer.safe.answers - 1, share, 0.05).power, 0.8);
    for (std::int64_t n = answer.safe.answers; n < 3 * answer.safe.answers; ++n) {
      EXPECT_GE(exact_test(n, share, 0.05).power, 0.8) << n;
    }
    EXPECT_EQ(answer.participants, answer.safe.answers);
  }
}

// With clustering, the planned number of participants gives the planned power to a corrected test.
TEST(Power, HoldsInSimulatedClusteredStudies) {
  PowerQuestion question;
  question.share = 0.65;
  question.trials = 8;
  question.icc = 0.15;
  const PowerAnswer answer = participants_needed(question);
  const Rng rng = make_rng(RandomUse::study, 21);
  const double scale = 1.0 / question.icc - 1.0;
  int found = 0;
  constexpr int studies = 2000;
  for (int study = 0; study < studies; ++study) {
    std::vector<Cluster> clusters;
    for (std::int64_t i = 0; i < answer.participants; ++i) {
      const double share =
          gsl_ran_beta(rng.get(), question.share * scale, (1.0 - question.share) * scale);
      clusters.push_back({8, static_cast<int>(gsl_ran_binomial(rng.get(), share, 8))});
    }
    const RaoScott result = rao_scott(clusters);
    found += result.p_f && result.p_f.value <= 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(found) / studies, answer.safe.power, 0.04);
}

TEST(Power, RefusesQuestionsWithoutAnAnswer) {
  const auto refuse = [](auto change) {
    PowerQuestion question;
    question.share = 0.75;
    change(question);
    EXPECT_THROW(participants_needed(question), InputError);
  };
  refuse([](PowerQuestion& q) { q.share = 0.5; });
  refuse([](PowerQuestion& q) { q.share = 0.0; });
  refuse([](PowerQuestion& q) { q.share = 1.0; });
  refuse([](PowerQuestion& q) { q.share = std::nan(""); });
  refuse([](PowerQuestion& q) { q.share = 0.50001; });
  refuse([](PowerQuestion& q) { q.alpha = 0.0; });
  refuse([](PowerQuestion& q) { q.alpha = 1.0; });
  refuse([](PowerQuestion& q) { q.power = 0.05; });
  refuse([](PowerQuestion& q) { q.power = 1.0; });
  refuse([](PowerQuestion& q) { q.trials = 0; });
  refuse([](PowerQuestion& q) { q.icc = -0.1; });
  refuse([](PowerQuestion& q) { q.icc = std::nan(""); });
}

}  // namespace
}  // namespace pinchlab::analysis
