// SPDX-License-Identifier: GPL-3.0-or-later
#include <gsl/gsl_randist.h>

#include <cmath>

#include "analysis/clustered.h"
#include "analysis/size_study.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

TEST(ClusteredDataSet, MeetsTheReferences) {
  const AnswersTable table = test::clustered_table();
  ASSERT_EQ(table.groups.back().name, "all");
  const Pooled pooled = pooled_tests(table, table.groups.back(), 0.05, 999, 1);
  EXPECT_NEAR(pooled.chi_square.value, 32.0, 1e-12);
  EXPECT_NEAR(pooled.p_naive.value, 1.54173e-8, 5e-14);
  EXPECT_NEAR(pooled.rao_scott.design_effect.value, 0.266667, 5e-7);
  EXPECT_NEAR(pooled.rao_scott.chi_square.value, 120.0, 1e-9);
  EXPECT_NEAR(pooled.sign_flip.p.value, 3.05176e-5, 5e-11);
  EXPECT_EQ(pooled.sign_flip.p.value, 2.0 / 65536.0);  // all 16 prefer pinch: 2 of 2^16 patterns
  EXPECT_TRUE(pooled.sign_flip.exact);
  const CochranQ q = cochran_q(table, table.groups.back());
  EXPECT_NEAR(q.q.value, 16.860215, 5e-7);
  EXPECT_EQ(q.df.value, 7.0);
  EXPECT_NEAR(q.p.value, 0.0183201, 5e-8);
  EXPECT_EQ(q.participants, 16);
}

TEST(SignFlip, AgreesWithCountingEveryPattern) {
  const Rng rng = make_rng(RandomUse::study, 7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<std::int64_t> scores(1 + gsl_rng_uniform_int(rng.get(), 10));
    std::int64_t observed = 0;
    for (auto& score : scores) {
      score = static_cast<std::int64_t>(gsl_rng_uniform_int(rng.get(), 9)) - 4;
      observed += score;
    }
    int as_far = 0;
    for (unsigned pattern = 0; pattern < 1U << scores.size(); ++pattern) {
      std::int64_t sum = 0;
      for (size_t i = 0; i < scores.size(); ++i)
        sum += (pattern >> i & 1U) != 0U ? scores[i] : -scores[i];
      as_far += std::abs(sum) >= std::abs(observed) ? 1 : 0;
    }
    const double counted = as_far / std::pow(2.0, static_cast<double>(scores.size()));
    EXPECT_EQ(sign_flip_test(scores, RandomUse::sign_flip, 1).p.value, counted);
  }
}

// Where the exact sum is out of reach, random flips come close to what it would have been.
TEST(SignFlip, MonteCarloAgreesWithTheNormalLimit) {
  std::vector<std::int64_t> scores;
  scores.reserve(60000);
  for (int i = 0; i < 60000; ++i) scores.push_back(i % 2 == 0 ? 3 : -2);
  for (int i = 0; i < 250; ++i) scores[static_cast<size_t>(i)] = -3;
  scores.resize(59000);
  double sum = 0.0, squares = 0.0;
  for (auto score : scores)
    sum += static_cast<double>(score), squares += static_cast<double>(score * score);
  // Shift the sum to about 1.5 standard deviations by flipping signs of pairs.
  for (size_t i = 0; i < scores.size() && sum > 1.5 * std::sqrt(squares); ++i) {
    if (scores[i] > 0) sum -= 2.0 * static_cast<double>(scores[i]), scores[i] = -scores[i];
  }
  const SignFlip flip = sign_flip_test(scores, RandomUse::sign_flip, 5);
  EXPECT_FALSE(flip.exact);
  const double normal = std::erfc(sum / std::sqrt(2.0 * squares));
  EXPECT_NEAR(flip.p.value, normal, 4.0 * std::sqrt(normal * (1.0 - normal) / 99999.0) + 1e-3);
}

// Distinct sizes out of reach of the exact sum, all of one sign: no flip of 99999 comes as far, and
// p is that of the sample itself, one in 100000, never 0.
TEST(SignFlip, MonteCarloIsNeverCertain) {
  std::vector<std::int64_t> scores;
  for (std::int64_t i = 0; i < 60; ++i) scores.push_back(1000003 * (i + 1) + i * i);
  const SignFlip flip = sign_flip_test(scores, RandomUse::sign_flip, 1);
  EXPECT_FALSE(flip.exact);
  EXPECT_DOUBLE_EQ(flip.p.value, 1e-5);
}

TEST(Pooled, SwappingTheMethodsChangesNoPValue) {
  const AnswersTable table = test::clustered_table();
  AnswersTable swapped = table;
  for (Answer& answer : swapped.answers) answer.chose_pinch = !answer.chose_pinch;
  for (Counts& counts : swapped.counts) std::swap(counts.pinch, counts.cable);
  for (const Group& group : table.groups) {
    const Pooled a = pooled_tests(table, group, 0.05, 999, 1);
    const Pooled b = pooled_tests(swapped, group, 0.05, 999, 1);
    EXPECT_EQ(a.chi_square.value, b.chi_square.value);
    EXPECT_NEAR(a.rao_scott.chi_square.value, b.rao_scott.chi_square.value, 1e-9);
    EXPECT_NEAR(a.rao_scott.p_f.value, b.rao_scott.p_f.value, 1e-12);
    EXPECT_EQ(a.sign_flip.p.value, b.sign_flip.p.value);
    EXPECT_NEAR(cochran_q(table, group).q.value, cochran_q(swapped, group).q.value, 1e-9);
  }
}

// A single answer a participant: clusters are answers, and the design effect is N/(N-1).
TEST(RaoScott, OneAnswerAParticipantIsTheNaiveTestAlmost) {
  std::vector<Cluster> clusters(20, {1, 1});
  for (size_t i = 0; i < 6; ++i) clusters[i].pinch = 0;
  const RaoScott result = rao_scott(clusters);
  EXPECT_NEAR(result.design_effect.value, 20.0 / 19.0, 1e-12);
  EXPECT_FALSE(result.icc);
}

// Participants who give one answer eight times: the design effect is about eight.
TEST(RaoScott, PerfectCorrelationCountsParticipants) {
  std::vector<Cluster> clusters(20, {8, 8});
  for (size_t i = 0; i < 6; ++i) clusters[i].pinch = 0;
  const RaoScott result = rao_scott(clusters);
  EXPECT_NEAR(result.design_effect.value, 8.0 * 20.0 / 19.0, 1e-12);
  EXPECT_NEAR(result.icc.value, 1.0, 0.07);
  EXPECT_NEAR(result.chi_square.value, 3.2 * 19.0 / 20.0, 1e-12);  // 14 to 6: X^2 = 64 / 20
}

TEST(Degenerate, ZeroVarianceBetweenParticipantsIsNullWithAReason) {
  const std::vector<Cluster> alike(10, {8, 6});
  const RaoScott result = rao_scott(alike);
  ASSERT_TRUE(result.design_effect);
  EXPECT_EQ(result.design_effect.value, 0.0);
  EXPECT_FALSE(result.chi_square);
  EXPECT_FALSE(result.p);
  EXPECT_NE(result.chi_square.why_not.find("variance"), std::string::npos);
  const Rng rng = make_rng(RandomUse::bootstrap, 1);
  EXPECT_FALSE(cluster_bootstrap(alike, 0.05, 99, rng.get()).p);
  EXPECT_EQ(sign_flip_test(preference_scores(alike), RandomUse::sign_flip, 1).p.value,
            2.0 / 1024.0);
}

TEST(Degenerate, SharesThatAreNoBinaryFractionStillHaveZeroVariance) {
  for (int answers = 1; answers <= 30; ++answers) {
    for (int pinch = 1; pinch < answers; ++pinch) {
      const std::vector<Cluster> alike(7, {answers, pinch});
      EXPECT_FALSE(rao_scott(alike).chi_square) << pinch << " of " << answers;
    }
  }
}

TEST(Degenerate, OneParticipantAndOneChoice) {
  const std::vector<Cluster> one{{8, 6}};
  EXPECT_FALSE(rao_scott(one).design_effect);
  EXPECT_EQ(sign_flip_test(preference_scores(one), RandomUse::sign_flip, 1).p.value, 1.0);
  const std::vector<Cluster> same(5, {8, 8});
  EXPECT_FALSE(rao_scott(same).design_effect);
  EXPECT_FALSE(rao_scott(same).chi_square);
  EXPECT_FALSE(rao_scott({}).chi_square);
}

TEST(Bootstrap, IntervalAndPValueAgree) {
  const Rng rng = make_rng(RandomUse::study, 3);
  for (int study = 0; study < 200; ++study) {
    const auto clusters = simulate_study({12, 8, 0.2}, rng.get());
    const Rng resampling = make_rng(RandomUse::bootstrap, 9);
    const ClusterBootstrap result = cluster_bootstrap(clusters, 0.05, 999, resampling.get());
    if (!result.low) continue;
    EXPECT_EQ(result.p.value <= 0.05, result.low.value > 0.5 || result.high.value < 0.5);
  }
}

TEST(Bootstrap, SameSeedSameResult) {
  const Rng rng = make_rng(RandomUse::study, 3);
  const auto clusters = simulate_study({50, 24, 0.2}, rng.get());
  const auto low = [&](std::uint64_t seed) {
    const Rng resampling = make_rng(RandomUse::bootstrap, seed);
    return cluster_bootstrap(clusters, 0.05, 999, resampling.get()).low.value;
  };
  EXPECT_EQ(low(42), low(42));
  EXPECT_NE(low(42), low(43));
}

TEST(CochranQ, NullWhereNobodyDiffers) {
  const AnswersTable table = test::table_of(
      "participant,demonstration,choice\na,1,pinch\na,2,pinch\nb,1,cable\nb,2,cable\n");
  EXPECT_FALSE(cochran_q(table, table.groups.back()).q);
}

// Of one participant Q is df for any answers that differ, so that its p says nothing.
TEST(CochranQ, NullOfOneParticipant) {
  const AnswersTable table =
      test::table_of("participant,demonstration,choice\np,a,pinch\np,b,cable\np,c,pinch\n");
  const CochranQ q = cochran_q(table, table.groups.back());
  EXPECT_FALSE(q.q);
  EXPECT_EQ(q.p.why_not, "only one participant chose in every demonstration");
  const Report report = analyse_table(table, {.alpha = 0.5, .bootstrap = 99});
  const std::string words = plain_words(report, table);
  EXPECT_EQ(words.find("differ from one another"), std::string::npos) << words;
  EXPECT_NE(words.find("how participants differ). Taken"), std::string::npos) << words;
}

// Cochran's Q is of those who chose in every demonstration; the report says how many these are.
TEST(CochransQ, SaysWhoItIsOf) {
  ReadOptions options;
  options.allow_missing = true;
  const AnswersTable apart = test::table_of(
      "participant,demonstration,choice\na,1,pinch\nb,1,cable\nc,2,pinch\nd,2,cable\n", options);
  const CochranQ none = cochran_q(apart, apart.groups.back());
  EXPECT_EQ(none.participants, 0);
  EXPECT_NE(none.p.why_not.find("no participant chose in every demonstration"), std::string::npos)
      << none.p.why_not;

  std::string csv = "participant,demonstration,choice\n";
  for (int i = 0; i < 8; ++i) csv += fmt::format("p{0},1,pinch\np{0},2,cable\n", i);
  csv += "q,1,pinch\nr,2,cable\n";
  const AnswersTable table = test::table_of(csv, options);
  const Report report = analyse_table(table, {});
  const std::string words = plain_words(report, table);
  EXPECT_NE(words.find("(Cochran's Q = 8.00 over the 8 of 10 participants who chose in all of "
                       "them, df 1, p = 0.0047)"),
            std::string::npos)
      << words;
  EXPECT_NE(report_markdown(report, table).find("| 8 | 8.000 | 1 | **0.0047** |"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::analysis
