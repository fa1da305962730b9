// SPDX-License-Identifier: GPL-3.0-or-later
// Stopping rules.
#include "analysis/sequential.h"

#include <gsl/gsl_randist.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/gsl_support.h"
#include "base/design_file.h"
#include "base/input_error.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

const std::vector<double> fifths = {0.2, 0.4, 0.6, 0.8, 1.0};

// Five equal looks, two-sided 0.05: the figures that the program of Reboussin, DeMets, Kim and Lan
// (Controlled Clinical Trials 21 (2000) 190) and R's ldbounds print, whose integration is good to
// about 1e-4; R's own `integrate` gives 3.357011922 for the second.
TEST(Sequential, BoundsAreThePublishedOnes) {
  const double obrien_fleming[] = {4.8769, 3.3569, 2.6803, 2.2898, 2.0310};
  const double pocock[] = {2.4380, 2.4268, 2.4101, 2.3966, 2.3859};
  const std::vector<Look> of = sequential_bounds(Spending::obrien_fleming, 0.05, fifths);
  const std::vector<Look> po = sequential_bounds(Spending::pocock, 0.05, fifths);
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(of[i].z, obrien_fleming[i], 2e-4) << i;
    EXPECT_NEAR(po[i].z, pocock[i], 2e-4) << i;
  }
  EXPECT_NEAR(of[0].z, 4.876884949, 1e-8);
  EXPECT_NEAR(of[1].z, 3.357011922, 1e-8);
  EXPECT_NEAR(of.back().spent, 0.05, 1e-12);
  EXPECT_NEAR(po.back().spent, 0.05, 1e-12);
  const std::vector<Look> one = sequential_bounds(Spending::pocock, 0.05, {1.0});
  EXPECT_NEAR(one[0].z, 1.959964, 1e-6);
}

// A simulated Brownian motion leaves the bounds as often as they say.
TEST(Sequential, BrownianMotionLeavesThemWithProbabilityAlpha) {
  const std::vector<double> uneven = {0.15, 0.5, 0.6, 1.0};
  const std::vector<Look> looks = sequential_bounds(Spending::pocock, 0.1, uneven);
  const Rng rng = make_rng(RandomUse::study, 4);
  int left = 0;
  constexpr int motions = 200000;
  for (int i = 0; i < motions; ++i) {
    double b = 0.0, before = 0.0;
    for (const Look& look : looks) {
      b += gsl_ran_gaussian(rng.get(), std::sqrt(look.fraction - before));
      before = look.fraction;
      if (std::abs(b) >= look.z * std::sqrt(look.fraction)) {
        ++left;
        break;
      }
    }
  }
  EXPECT_NEAR(static_cast<double>(left) / motions, 0.1, 4 * std::sqrt(0.09 / motions));
}

StoppingQuestion question(StoppingRule rule) {
  StoppingQuestion q;
  q.rule = rule;
  q.participants = {12, 24, 36, 48};
  q.truth.share = 0.65;
  q.truth.trials = 8;
  q.truth.icc = 0.2;
  return q;
}

TEST(Sequential, RulesKeepTheLevelAndSaveParticipants) {
  const StoppingAnswer fixed = stopping_rule(question(StoppingRule::fixed), 2000, 1);
  EXPECT_EQ(fixed.looks.size(), 1U);
  EXPECT_EQ(fixed.with.participants, 48);
  for (const StoppingRule rule : {StoppingRule::obrien_fleming, StoppingRule::pocock}) {
    const StoppingAnswer answer = stopping_rule(question(rule), 2000, 1);
    EXPECT_EQ(answer.looks.size(), 4U);
    EXPECT_LE(answer.without.finds, 0.05 + 3 * std::sqrt(0.05 * 0.95 / 2000));
    EXPECT_GT(answer.without.finds, 0.02);
    EXPECT_LT(answer.with.participants, 0.8 * fixed.with.participants);
    EXPECT_GT(answer.with.finds, fixed.with.finds - 0.08);
    double stopped = 0.0;
    for (const double share : answer.with.stopped_at) stopped += share;
    EXPECT_NEAR(stopped, 1.0, 1e-9);
  }
  // Looking four times at the level of one look finds too much.
  StoppingQuestion naive = question(StoppingRule::fixed);
  int found = 0;
  constexpr int studies = 2000;
  const std::vector<double> one = [&] {
    PowerQuestion none = naive.truth;
    none.share = 0.5;
    return answers_of_one(none);
  }();
  for (int i = 0; i < studies; ++i) {
    const Rng rng = make_rng(RandomUse::power, 3, static_cast<std::uint64_t>(i));
    std::vector<unsigned> drawn(one.size()), more(one.size());
    bool stops = false;
    for (const std::int64_t n : naive.participants) {
      gsl_ran_multinomial(rng.get(), one.size(), 12, one.data(), more.data());
      for (size_t k = 0; k < one.size(); ++k) drawn[k] += more[k];
      stops = stops || sign_flips_reject(drawn, n, 0.05);
    }
    found += stops ? 1 : 0;
  }
  EXPECT_GT(found, studies / 12);
}

// Five coins fall alike with a p of 1/16.
TEST(Sequential, BoundsThatNoAnswersReachAreTold) {
  StoppingQuestion q = question(StoppingRule::obrien_fleming);
  q.participants = {5, 10, 40};
  const std::string text = stopping_text(q, stopping_rule(q, 100, 1));
  EXPECT_NE(text.find("\nWith 5 participants p is 0.0625 at least: no answers stop it there.\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("With 40"), std::string::npos) << text;
  q.participants = {24, 48};
  EXPECT_EQ(stopping_text(q, stopping_rule(q, 100, 1)).find("at least"), std::string::npos);
}

// 2^10 B(11, 1) = 2^10 / 11 and 2^10 B(6, 6) = 2^10 / 2772 of ten answers; 1/10 needs 160 and more.
TEST(Sequential, BayesFactorsThatNoAnswersReachAreTold) {
  StoppingQuestion q = question(StoppingRule::bayes_factor);
  q.truth.trials = 1;
  q.truth.icc = 0;
  q.bayes_factor = 10;
  q.participants = {1, 5, 10, 320};
  const std::string text = stopping_text(q, stopping_rule(q, 100, 1));
  const auto has = [&](const char* sentence) { return text.find(sentence) != std::string::npos; };
  EXPECT_TRUE(has("\nWith 1 participant the Bayes factor is 1 to 1: no answers stop it there.\n"));
  EXPECT_TRUE(has("With 5 participants the Bayes factor is 0.533 to 5.33: no answers stop it"))
      << text;
  EXPECT_TRUE(
      has("\nWith 10 participants the Bayes factor is 0.369 at least: no answers say there "
          "that none is preferred.\n"))
      << text;
  EXPECT_FALSE(has("With 320"));
}

TEST(Sequential, BayesFactorsStopBothWays) {
  StoppingQuestion q = question(StoppingRule::bayes_factor);
  q.truth.trials = 1;
  q.truth.icc = 0;
  q.truth.share = 0.75;
  q.participants = {20, 40, 80, 160, 320};
  const StoppingAnswer answer = stopping_rule(q, 2000, 1);
  EXPECT_GT(answer.with.finds, 0.98);
  EXPECT_LT(answer.without.finds, 0.05);
  EXPECT_GT(answer.without.finds_none, 0.3);
  EXPECT_NE(stopping_text(q, answer).find("none in"), std::string::npos);
}

TEST(Sequential, ARuleThatIsWrittenIsReadBack) {
  for (const StoppingRule rule : {StoppingRule::fixed, StoppingRule::obrien_fleming,
                                  StoppingRule::pocock, StoppingRule::bayes_factor}) {
    StoppingQuestion q = question(rule);
    if (rule == StoppingRule::bayes_factor) {
      q.truth.trials = 1;
      q.truth.icc = 0;
    }
    const StoppingAnswer answer = stopping_rule(q, 100, 1);
    const Sample sample =
        parse_stopping(nlohmann::json::parse(stopping_json(q, answer)), "rule.json");
    EXPECT_EQ(sample.looks.back(), q.participants.back());
    EXPECT_EQ(sample.looks.size(), answer.looks.size());
    ASSERT_EQ(sample.p_at_most.size(),
              rule == StoppingRule::bayes_factor ? 0 : answer.looks.size());
    for (std::size_t i = 0; i < sample.p_at_most.size(); ++i)
      EXPECT_EQ(sample.p_at_most[i], answer.looks[i].nominal_p);
  }
  EXPECT_THROW(parse_stopping({{"format", "pinchlab-stopping 1"}, {"rule", "guess"}}, "rule.json"),
               InputError);
}

// A study that may be looked at several times claims a preference by the bound of the look that it
// has come to, which is below alpha; or by its Bayes factor.
TEST(Sequential, APreferenceIsClaimedAsTheLookAsks) {
  std::string csv = "participant,demonstration,choice\n";
  for (int i = 0; i < 40; ++i) csv += fmt::format("p{:02},1,{}\n", i, i < 27 ? "pinch" : "cable");
  AnswersTable table = test::table_of(csv);
  const Report report = analyse_table(table, {.bootstrap = 99});
  const double p = report.all().row.read.p.value;
  ASSERT_GT(p, 0.03);
  ASSERT_LT(p, 0.05);
  const auto claims = [&] {
    const std::string words = plain_words(report, table);
    const bool is_claimed = words.starts_with("Pinch was preferred to cable");
    EXPECT_NE(is_claimed, words.starts_with("No clear preference")) << words;
    return is_claimed;
  };
  EXPECT_TRUE(claims());
  table.design = DesignCheck{};
  EXPECT_TRUE(claims());  // of one look
  table.design->p_at_most = 0.0188;
  table.design->look = 24;  // whether so many were analysed or more
  EXPECT_FALSE(claims());
  EXPECT_NE(plain_words(report, table).find("the design asks for at its look at 24 participants"),
            std::string::npos);
  table.design->p_at_most = p;
  EXPECT_TRUE(claims());
  table.design->p_at_most.reset();
  table.design->bayes_factor = std::exp(report.all().row.log_bayes_factor) * 1.01;
  EXPECT_FALSE(claims());
  table.design->bayes_factor = std::exp(report.all().row.log_bayes_factor) * 0.99;
  EXPECT_TRUE(claims());
}

TEST(Sequential, RefusesWhatCannotBe) {
  const auto refuses = [](auto change) {
    StoppingQuestion q = question(StoppingRule::bayes_factor);
    q.truth.trials = 1;
    change(q);
    EXPECT_THROW(stopping_rule(q, 10, 1), InputError);
  };
  refuses([](StoppingQuestion& q) { q.participants = {}; });
  refuses([](StoppingQuestion& q) { q.participants = {20, 20}; });
  refuses([](StoppingQuestion& q) { q.participants = {0, 20}; });
  refuses([](StoppingQuestion& q) { q.truth.trials = 2; });
  refuses([](StoppingQuestion& q) { q.bayes_factor = 1; });
  refuses([](StoppingQuestion& q) { q.truth.share = 0.5; });
}

}  // namespace
}  // namespace pinchlab::analysis
