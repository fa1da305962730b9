// SPDX-License-Identifier: GPL-3.0-or-later
// Studies in which participants answer each demonstration more than once: the participant is the
// unit.
#include <gsl/gsl_randist.h>

#include <cmath>

#include "analysis/gsl_support.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::json;

// A study without any true preference: each participant has an own share for each demonstration,
// drawn from Beta(a, a) so that repeated answers have the intraclass correlation `icc`.
AnswersTable study_without_effect(int participants, int demonstrations, int repetitions, double icc,
                                  gsl_rng* rng) {
  AnswersTable table;
  const double shape = 0.5 * (1.0 / icc - 1.0);
  table.answers_per_demonstration = repetitions;
  table.counts.resize(static_cast<size_t>(demonstrations));
  for (int j = 0; j < demonstrations; ++j) table.demonstrations.push_back(fmt::format("d{}", j));
  for (int i = 0; i < participants; ++i) {
    table.participants.push_back(fmt::format("p{}", i));
    for (int j = 0; j < demonstrations; ++j) {
      const double share = gsl_ran_beta(rng, shape, shape);
      for (int r = 0; r < repetitions; ++r) {
        Answer answer;
        answer.participant = static_cast<std::uint32_t>(i);
        answer.demonstration = static_cast<std::uint16_t>(j);
        answer.chose_pinch = gsl_rng_uniform(rng) < share;
        Counts& counts = table.counts[answer.demonstration];
        ++(answer.chose_pinch ? counts.pinch : counts.cable);
        table.answers.push_back(answer);
      }
    }
  }
  Group all{"all", {}};
  for (int j = 0; j < demonstrations; ++j)
    all.demonstrations.push_back(static_cast<std::uint16_t>(j));
  table.groups.push_back(all);
  return table;
}

struct Rates {
  double flips = 0.0, naive = 0.0, missed = 0.0, cochran = 0.0;
};

Rates rates_of(int repetitions, int studies) {
  Rates rates;
  for (int study = 0; study < studies; ++study) {
    const Rng rng = make_rng(RandomUse::study, 31, static_cast<std::uint64_t>(study));
    const AnswersTable table = study_without_effect(16, 4, repetitions, 0.5, rng.get());
    for (std::uint16_t j = 0; j < 4; ++j) {
      const Pooled pooled = pooled_tests(table, {"one", {j}}, 0.05, 199, 1);
      const auto& [low, high, p, resamples] = pooled.bootstrap;
      rates.flips += pooled.sign_flip.p.value <= 0.05 ? 0.25 : 0.0;
      rates.naive += pooled.p_naive.value <= 0.05 ? 0.25 : 0.0;
      rates.missed += low && (low.value > 0.5 || high.value < 0.5) ? 0.25 : 0.0;
    }
    rates.cochran += cochran_q(table, table.groups.back()).p.value <= 0.05 ? 1.0 : 0.0;
  }
  for (double* rate : {&rates.flips, &rates.naive, &rates.missed, &rates.cochran}) *rate /= studies;
  return rates;
}

class RepeatedAnswers : public testing::TestWithParam<int> {};

TEST_P(RepeatedAnswers, EachDemonstrationHoldsItsSize) {
  constexpr int studies = 2000;
  const Rates rates = rates_of(GetParam(), studies);
  const double se = std::sqrt(0.05 * 0.95 / (4.0 * studies));
  EXPECT_LE(rates.flips, 0.05 + 3.0 * se);
  EXPECT_GE(rates.flips, 0.02);  // not by never rejecting
  EXPECT_LE(rates.missed, 0.05 + 3.0 * se);
  EXPECT_GT(rates.naive, GetParam() == 2 ? 0.09 : 0.15);  // answers counted as independent
  EXPECT_NEAR(rates.cochran, 0.05, 3.0 * std::sqrt(0.05 * 0.95 / studies));
}

INSTANTIATE_TEST_SUITE_P(Repetitions, RepeatedAnswers, testing::Values(2, 4));

TEST(RepeatedAnswers, NothingThatTakesThemAsIndependentIsGiven) {
  const Rng rng = make_rng(RandomUse::study, 5);
  const AnswersTable table = study_without_effect(16, 3, 2, 0.5, rng.get());
  const Report report = analyse_table(table, {});
  const json document = json::parse(report_json(report, table));
  for (const json& row : document["demonstrations"]) {
    for (const char* key : {"chi_square", "p_chi_square", "p_exact", "wilson_low", "wilson_high",
                            "clopper_pearson_low", "p_holm", "p_bh", "bayes_factor"}) {
      EXPECT_TRUE(row[key].is_null()) << key;
      EXPECT_NE(row[std::string(key) + "_reason"].get<std::string>().find("more than once"),
                std::string::npos);
    }
    EXPECT_TRUE(row["p_read"].is_number());
    EXPECT_EQ(row["test_read"], "sign-flip test over participants");
    EXPECT_TRUE(row["low_read"].is_number());
  }
  EXPECT_TRUE(document["heterogeneity"]["p"].is_null());
  EXPECT_TRUE(document["cochran_q"]["p"].is_number());
  EXPECT_NE(plain_words(report, table).find("sign-flip test over participants"), std::string::npos);
  EXPECT_EQ(report_markdown(report, table).find("Clopper–Pearson % |"),
            report_markdown(report, table).rfind("Clopper–Pearson % |"));  // of groups alone
}

TEST(RepeatedAnswers, OneParticipantIsRefusedWithTheReason) {
  ReadOptions options;
  options.repetitions = 2;
  const AnswersTable table = test::table_of(
      "participant,demonstration,choice\na,1,pinch\na,1,pinch\na,2,pinch\na,2,cable\n", options);
  const Report report = analyse_table(table, {});
  const Reading& read = report.demonstrations[0].row.read;
  EXPECT_FALSE(read.p);
  EXPECT_FALSE(read.low);
  EXPECT_NE(read.p.why_not.find("one participant"), std::string::npos);
  EXPECT_NE(plain_words(report, table).find("cannot be tested one by one"), std::string::npos);
}

// Whatever one participant chose, nothing follows for people.
TEST(RepeatedAnswers, NothingIsClaimedOfOneParticipant) {
  ReadOptions options;
  options.repetitions = 8;
  std::string csv = "participant,demonstration,choice\n";
  for (int i = 0; i < 24; ++i) csv += fmt::format("a,{},pinch\n", i % 3);
  const AnswersTable table = test::table_of(csv, options);
  const Report report = analyse_table(table, {});
  EXPECT_FALSE(report.all().row.read.p);
  EXPECT_FALSE(report.all().row.read.low);
  const std::string words = plain_words(report, table);
  EXPECT_TRUE(words.starts_with("No clear preference between pinch and cable: 24 of 24 answers"))
      << words;
  EXPECT_NE(words.find("no p-value: one participant"), std::string::npos) << words;
}

TEST(RepeatedAnswers, AnswersAreNotCalledPeople) {
  ReadOptions options;
  options.repetitions = 4;
  std::string csv = "participant,demonstration,choice\n";
  for (int i = 0; i < 24; ++i) csv += fmt::format("p{},d,{}\n", i % 6, i < 20 ? "pinch" : "cable");
  const AnswersTable table = test::table_of(csv, options);
  const std::string words = plain_words(analyse_table(table, {}), table);
  EXPECT_NE(words.find("20 of 24 answers chose pinch in demonstration d"), std::string::npos)
      << words;
}

// Of two demonstrations one was answered by a single participant, twice for pinch: nothing is known
// of how participants differ there, whichever comes first.
void expect_one_untested(const std::string& untested, const std::string& tested) {
  ReadOptions options;
  options.repetitions = 2;
  options.allow_missing = true;
  std::string csv = "participant,demonstration,choice\n";
  for (const char* who : {"a", "b", "c", "d", "e", "f", "g"})
    csv += fmt::format("{0},{1},pinch\n{0},{1},pinch\n", who, tested);
  csv += fmt::format("a,{0},pinch\na,{0},pinch\n", untested);
  const AnswersTable table = test::table_of(csv, options);
  const Report report = analyse_table(table, {});
  const auto expect_in = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
  };
  const std::string words = plain_words(report, table), page = report_markdown(report, table);
  expect_in(words,
            "(sign-flip test over participants, p < 0.05), pinch was preferred in 1 of 2 "
            "demonstrations: " +
                tested + " (14 of 14).");
  expect_in(words, "Not tested, for want of a second participant: " + untested + " (2 of 2).");
  expect_in(words, "testing so many, " + tested + " remains.");
  expect_in(page, "p-value (sign-flip test over participants)");
  expect_in(page, "A test of one half is not given for " + untested + ": one participant");
  expect_in(page, "An interval is not given for " + tested + ": participants do not differ");
  expect_in(make_figures(report).front().caption, "(cluster bootstrap)");
}

TEST(RepeatedAnswers, NothingIsClaimedOfADemonstrationWithoutATest) {
  expect_one_untested("x", "y");
  expect_one_untested("y", "x");
}

// With two repetitions, scores 0 to 2: Q is (K - 1) times the sum of squared deviations of the
// column sums over the sum of the participants' squared deviations (Friedman's construction).
TEST(RepeatedAnswers, CochransQTakesTheirNumberAsScore) {
  ReadOptions options;
  options.repetitions = 2;
  const AnswersTable table = test::table_of(
      "participant,demonstration,choice\n"
      "a,1,pinch\na,1,pinch\na,2,cable\na,2,cable\nb,1,pinch\nb,1,pinch\nb,2,pinch\nb,2,cable\n"
      "c,1,cable\nc,1,pinch\nc,2,pinch\nc,2,pinch\n",
      options);
  // Scores (2, 0), (2, 1), (1, 2): columns 5 and 3, deviations 1 and 1, (1 + 1), .5, .5.
  const CochranQ q = cochran_q(table, table.groups.back());
  EXPECT_NEAR(q.q.value, 1.0 * 2.0 / 3.0, 1e-12);
  EXPECT_EQ(q.participants, 3);
}

// R: mantelhaen.test(array(c(9,4,1,6, 7,8,3,2, 2,1,9,8), c(2,2,3)), correct = FALSE).
AnswersTable sides(const int (&cells)[3][4]) {
  std::string csv = "participant,demonstration,choice,side\n";
  for (int j = 0; j < 3; ++j) {
    int person = 0;
    for (int cell = 0; cell < 4; ++cell) {
      for (int i = 0; i < cells[j][cell]; ++i) {
        csv += fmt::format("p{:02},{},{},{}\n", person++, j, cell < 2 ? "pinch" : "cable",
                           cell % 2 == 0 ? "left" : "right");
      }
    }
  }
  return test::table_of(csv);
}

TEST(SideBias, IsStratifiedAsInR) {
  const AnswersTable table = sides({{9, 4, 1, 6}, {7, 8, 3, 2}, {2, 1, 9, 8}});
  const SideBias bias = side_bias(table, 1);
  EXPECT_NEAR(bias.chi_square.value, 1.938703866229, 1e-9);
  EXPECT_NEAR(bias.p.value, 0.163809335408, 1e-10);
}

TEST(SideBias, APreferenceForPinchOnUnbalancedSidesIsNone) {
  // Pinch is on the left in 36 of 60 answers and chosen in five of six on either side: by raw
  // counts the left clip is chosen 34 times and the right 26 times, and with more answers
  // "significantly" so.
  const AnswersTable table = sides({{10, 6, 2, 2}, {10, 7, 2, 1}, {10, 7, 2, 1}});
  const SideBias bias = side_bias(table, 1);
  EXPECT_EQ(bias.chosen.pinch, 34);
  EXPECT_NEAR(bias.bias.value, 0.0, 0.02);
  EXPECT_GT(bias.p.value, 0.5);
  EXPECT_GT(bias.p_sign_flip.value, 0.5);
}

TEST(SideBias, IsFoundWhereThereIsOne) {
  const SideBias bias = side_bias(sides({{9, 2, 1, 8}, {9, 2, 1, 8}, {9, 2, 1, 8}}), 1);
  EXPECT_NEAR(bias.bias.value, 0.35, 1e-12);
  EXPECT_LT(bias.p.value, 1e-6);
  EXPECT_LT(bias.p_sign_flip.value, 0.005);
}

// A demonstration with one answer tells nothing of sides, and has no variance, not 0 / 0.
TEST(SideBias, ADemonstrationOfOneAnswerCountsNothing) {
  AnswersTable table = sides({{9, 4, 1, 6}, {7, 8, 3, 2}});
  const SideBias without = side_bias(table, 1);
  table.demonstrations.emplace_back("2");
  table.answers.push_back(table.answers.back());
  table.answers.back().demonstration = 2;
  const SideBias with = side_bias(table, 1);
  EXPECT_EQ(with.chosen.total(), without.chosen.total() + 1);
  EXPECT_GT(with.chi_square.value, 0.0);
  EXPECT_EQ(with.chi_square.value, without.chi_square.value);
  EXPECT_EQ(with.bias.value, without.bias.value);
}

// Answers whose position was not recorded are in no order, least of all in that of the file.
TEST(OrderEffect, IsNoneWhereNoPositionWasRecorded) {
  AnswersTable table = sides({{9, 4, 1, 6}, {7, 8, 3, 2}});
  for (Answer& answer : table.answers) ASSERT_EQ(answer.position, 0);
  const OrderEffect none = order_effect(table, 1);
  EXPECT_TRUE(none.by_position.empty());
  EXPECT_FALSE(none.chi_square);
  EXPECT_FALSE(none.p_sign_flip);
  // Of those that were recorded the others take no place.
  for (Answer& answer : table.answers) {
    answer.position = static_cast<std::uint16_t>(answer.demonstration == 0 ? 0 : 7);
  }
  const OrderEffect some = order_effect(table, 1);
  ASSERT_EQ(some.by_position.size(), 1U);
  EXPECT_EQ(some.by_position[0].pinch, 15);
  EXPECT_EQ(some.by_position[0].cable, 5);
}

}  // namespace
}  // namespace pinchlab::analysis
