// SPDX-License-Identifier: GPL-3.0-or-later
// Preferences in grades: Wilcoxon's test against its definition, ties in no count of choices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "analysis/comparisons_table.h"
#include "analysis/graded_preference.h"
#include "analysis/report.h"
#include "base/input_error.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

// By counting all ways to give the sizes their signs.
double by_enumeration(const std::vector<double>& scores) {
  std::vector<double> sizes;
  for (const double score : scores) {
    if (score != 0) sizes.push_back(std::abs(score));
  }
  std::vector<double> ranks;
  for (const double size : sizes) {
    double rank = 0.5;
    for (const double other : sizes) rank += other < size ? 1 : other == size ? 0.5 : 0;
    ranks.push_back(rank);
  }
  double observed = 0, middle = 0;
  std::size_t i = 0;
  for (const double score : scores) {
    if (score == 0) continue;
    observed += score > 0 ? ranks[i] : 0;
    middle += ranks[i++] / 2;
  }
  long extreme = 0;
  const long all = 1L << ranks.size();
  for (long signs = 0; signs < all; ++signs) {
    double sum = 0;
    for (std::size_t k = 0; k < ranks.size(); ++k) sum += (signs >> k & 1) != 0 ? ranks[k] : 0;
    extreme += std::abs(sum - middle) >= std::abs(observed - middle) - 1e-9 ? 1 : 0;
  }
  return static_cast<double>(extreme) / static_cast<double>(all);
}

TEST(SignedRank, AgreesWithItsDefinition) {
  const std::vector<std::vector<double>> samples = {
      {1},
      {-1, 2, 3},
      {0.5, -0.5, 1, 1, -2, 0, 0},
      {1, 2, 3, 4, 5, 6},
      {1.0 / 3, 2.0 / 6, -1.0 / 3, 2, 2, 2, -3, 0.25},
      {1.83, 0.50, 1.62, 2.48, 1.68, -1.88, 1.55, 3.06, -1.30},
      {-3, -3, -3, 1, 1, 1, 1, 1, 2, 2, 2, 2.5, -2.5, 0.1}};
  for (const auto& sample : samples) {
    const SignedRank result = signed_rank_test(sample);
    ASSERT_TRUE(result.p);
    EXPECT_TRUE(result.is_exact);
    EXPECT_NEAR(result.p.value, by_enumeration(sample), 1e-12);
  }
  // Six of one sign: 2 / 2^6 in both tests.
  EXPECT_DOUBLE_EQ(signed_rank_test({1, 2, 3, 4, 5, 6}).p.value, 0.03125);
  EXPECT_DOUBLE_EQ(signed_rank_test({1, 2, 3, 4, 5, 6}).p_sign.value, 0.03125);
  EXPECT_DOUBLE_EQ(signed_rank_test({1, 2, 3, 4, 5, 6}).w_plus, 21);
}

TEST(SignedRank, ManyScoresByTheNormal) {
  std::vector<double> scores;
  for (int i = 1; i <= 300; ++i) scores.push_back((i % 3 == 0 ? -1 : 1) * (i % 17 + 1));
  const SignedRank exact = signed_rank_test(scores);
  EXPECT_TRUE(exact.is_exact);
  scores.push_back(0);
  EXPECT_TRUE(signed_rank_test(scores).is_exact) << "zeros do not count";
  scores.back() = 1e-9;
  const SignedRank normal = signed_rank_test(scores);
  EXPECT_FALSE(normal.is_exact);
  EXPECT_NEAR(std::log(normal.p.value), std::log(exact.p.value), 0.5);
}

TEST(SignedRank, NothingToTestIsSaid) {
  const SignedRank result = signed_rank_test({0, 0});
  EXPECT_FALSE(result.p);
  EXPECT_FALSE(result.p_sign);
  EXPECT_EQ(result.zeros, 2U);
  EXPECT_FALSE(signed_rank_test({}).p);
}

json graded_document(const std::string& participant, int first, int second) {
  json document = test::answer_document(participant);
  const int grades[] = {first, second};
  std::size_t next = 0;
  for (json& trial : document["trials"]) {
    if (trial["kind"] != "main") continue;
    const int grade = grades[next++];
    trial["preference"] = grade;
    trial["choice"] = grade < 0 ? "left" : grade > 0 ? "right" : "tie";
  }
  return document;
}

TEST(Graded, TiesAreInNoCount) {
  const TemporaryFolder folder;
  folder.write("a.json", graded_document("p-1", 0, -3).dump());
  folder.write("b.json", graded_document("p-2", 0, 2).dump());
  folder.write("c.json", graded_document("p-3", 0, 0).dump());
  const AnswersTable table = read_answers({folder.path()}, {});
  EXPECT_TRUE(table.incomplete.empty());
  EXPECT_EQ(table.answers.size(), 2U);
  const Report report = analyse_table(table, {.bootstrap = 99});
  EXPECT_EQ(report.all().row.counts.total(), 2);
  ASSERT_FALSE(report.graded.empty());
  EXPECT_EQ(report.graded.back().name, "all");
  EXPECT_EQ(report.graded.back().answers, 6U);
  EXPECT_EQ(report.graded.back().ties, 4U);
  EXPECT_EQ(report.graded.back().participants, 3U);
  EXPECT_EQ(report.graded.back().test.zeros, 1U);
  const json rows = json::parse(report_json(report, table))["graded_preferences"]["rows"];
  EXPECT_EQ(rows.back()["ties"], 4);
  EXPECT_TRUE(rows[1]["p_signed_rank"].is_null()) << "only ties";
}

// A tie is an answer that was given, also where a demonstration has no other.
TEST(Graded, TiesCountAsGiven) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& rows) {
    return read_answers(
        {folder.write("a.csv", "participant,demonstration,choice,side,preference\n" + rows)}, {});
  };
  const auto refusal = [&](const std::string& rows) -> std::string {
    try {
      read(rows);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string whole =
      "p1,A,pinch,left,-1\np1,B,tie,left,0\np2,A,cable,left,1\np2,B,tie,left,0\n";
  EXPECT_EQ(refusal(whole), "");
  EXPECT_NE(plain_words(analyse_table(read(whole), {.bootstrap = 99}), read(whole))
                .find("all of those to B"),
            std::string::npos);
  // Not B; A twice; nothing but a tie, of two.
  EXPECT_NE(refusal("p1,A,pinch,left,-1\np2,A,cable,left,1\np2,B,tie,left,0\n")
                .find("`p1` gave 1 of 2 answers; missing: demonstration `B`"),
            std::string::npos);
  EXPECT_NE(refusal("p1,A,pinch,left,-1\np1,A,tie,left,0\n").find("`A` twice"), std::string::npos);
  EXPECT_NE(refusal(whole + "p3,B,tie,left,0\n").find("`p3` gave 1 of 2"), std::string::npos);
}

// Ties come first in each session, so that the choices are at the second to fourth places.
TEST(Graded, TiesTakeTheirPlacesInTheOrder) {
  std::string csv = "participant,demonstration,choice,side,preference,position\n";
  for (int p = 0; p < 6; ++p) {
    csv += fmt::format("p{0},a,tie,left,0,3\np{0},b,{1},left,{2},5\n", p, p < 2 ? "pinch" : "cable",
                       p < 2 ? -1 : 1);
    csv += fmt::format("p{0},c,{1},left,{2},7\np{0},d,pinch,left,-3,9\n", p,
                       p < 4 ? "pinch" : "cable", p < 4 ? -1 : 1);
  }
  csv += "p6,a,tie,left,0,3\np6,b,tie,left,0,5\np6,c,tie,left,0,7\np6,d,cable,left,1,9\n";
  const AnswersTable table = test::table_of(csv);
  const OrderEffect order = order_effect(table, 1);
  ASSERT_EQ(order.by_position.size(), 4U);
  EXPECT_EQ(order.by_position[0].total(), 0);
  const std::vector<std::pair<int, int>> counts = {{0, 0}, {2, 4}, {4, 2}, {6, 1}};
  for (size_t i = 0; i < counts.size(); ++i) {
    EXPECT_EQ(order.by_position[i].pinch, counts[i].first) << i;
    EXPECT_EQ(order.by_position[i].cable, counts[i].second) << i;
  }
  EXPECT_TRUE(order.p_trend);
  const Report report = analyse_table(table, {.bootstrap = 99});
  EXPECT_EQ(make_figures(report).back().script.find("nan"), std::string::npos);
  // Those at one place only tell nothing of an order.
  const OrderEffect none =
      order_effect(test::table_of("participant,demonstration,choice,side,preference,position\n"
                                  "p1,a,tie,left,0,1\np1,b,pinch,left,-1,2\np2,b,tie,left,0,1\n"
                                  "p2,a,cable,left,1,2\n"),
                   1);
  EXPECT_FALSE(none.p_trend);
  EXPECT_NE(none.p_trend.why_not.find("same place"), std::string::npos);
}

// Swapping first and last turns a trend round, wherever the ties are.
TEST(Graded, ASessionTheOtherWayRoundHasTheOppositeTrend) {
  const auto trend = [](int first, int step) {
    std::string csv = "participant,demonstration,choice,side,preference,position\n";
    for (const char* who : {"p", "q"}) {
      for (int i = 0; i < 5; ++i) {
        const char* choice = i < 2 ? "tie" : i < 3 ? "cable" : "pinch";
        csv += fmt::format("{},{},{},left,{},{}\n", who, i, choice,
                           i < 2   ? 0
                           : i < 3 ? 1
                                   : -1,
                           first + i * step);
      }
    }
    return order_effect(test::table_of(csv), 1).share_by_place.value;
  };
  EXPECT_NEAR(trend(1, 1), 0.5, 1e-12);
  EXPECT_NEAR(trend(5, -1), -0.5, 1e-12);
}

TEST(Graded, WhatWentInHasTheTiesToo) {
  const AnswersTable table = test::table_of(
      "participant,demonstration,choice,side,preference\np1,A,pinch,left,-1\np1,B,tie,left,0\n"
      "p2,A,cable,left,1\np2,B,tie,left,0\np3,A,tie,left,0\np3,B,tie,left,0\n");
  const Report report = analyse_table(table, {.bootstrap = 99});
  EXPECT_NE(report_markdown(report, table)
                .find("6 answers of 3 participants, 4 of them ties, to 2 demonstrations, read"),
            std::string::npos);
  const json input = json::parse(report_json(report, table))["input"];
  EXPECT_EQ(input["answers"], 6);
  EXPECT_EQ(input["ties"], 4);
  EXPECT_EQ(input["participants"], 3);
}

TEST(Graded, OneTieIsOne) {
  const AnswersTable table = test::table_of(
      "participant,demonstration,choice,side,preference\np1,A,cable,left,1\np1,B,tie,left,0\n"
      "p2,A,cable,left,1\np2,B,cable,right,-1\n");
  const Report report = analyse_table(table, {.bootstrap = 99});
  const std::string page = report_markdown(report, table);
  for (const char* sentence :
       {"1 of 4 answers was a tie, and is in no count here.",
        "1 of 4 answers was a tie: it is left", "4 answers of 2 participants, 1 of them a tie, to",
        "left clip was chosen 1 time and"}) {
    EXPECT_NE(page.find(sentence), std::string::npos) << sentence << "\n" << page;
  }
}

TEST(Graded, APlaceIsTakenByATieToo) {
  const auto refusal = [](const char* rows) -> std::string {
    try {
      test::table_of(std::string("participant,demonstration,choice,side,preference,position\n") +
                     rows);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("p1,A,pinch,left,-1,1\np1,B,tie,left,0,2\n"), "");
  EXPECT_NE(refusal("p1,A,pinch,left,-1,2\np1,B,tie,left,0,2\n")
                .find("`p1` has two answers at position 2, a tie among them"),
            std::string::npos);
}

TEST(Graded, TidyCsvReadsBackToTheSameReport) {
  const TemporaryFolder folder;
  const std::vector<int> first = {0, -3, 2, 0, 1}, second = {2, 0, -1, 0, 3};
  for (size_t i = 0; i < first.size(); ++i) {
    json document = graded_document(fmt::format("p-{}", i), first[i], second[i]);
    document["trials"][0]["reaction_time_s"] = 0.125 + static_cast<double>(i);
    folder.write(fmt::format("in/{}.json", i), document.dump());
  }
  const AnswersTable table = read_answers({folder.path() / "in"}, {});
  std::ostringstream out;
  write_tidy_csv(table, out);
  const AnswersTable again = read_answers({folder.write("answers.csv", out.str())}, {});
  EXPECT_EQ(again.answers.size(), table.answers.size());
  EXPECT_TRUE(again.incomplete.empty());
  const json before = json::parse(report_json(analyse_table(table, {.bootstrap = 99}), table));
  const json after = json::parse(report_json(analyse_table(again, {.bootstrap = 99}), again));
  for (const char* key : {"demonstrations", "groups", "graded_preferences", "side_bias",
                          "order_effect", "reaction_times"}) {
    EXPECT_EQ(after[key], before[key]) << key << "\n" << out.str();
  }
  EXPECT_EQ(after["input"]["ties"], before["input"]["ties"]);
  std::ostringstream twice;
  write_tidy_csv(again, twice);
  EXPECT_EQ(twice.str(), out.str());
}

TEST(Graded, NothingChangesWithout) {
  const TemporaryFolder folder;
  folder.write("a.json", test::answer_document("p-1").dump());
  const AnswersTable table = read_answers({folder.path()}, {});
  const Report report = analyse_table(table, {.bootstrap = 99});
  EXPECT_TRUE(report.graded.empty());
  EXPECT_EQ(report_json(report, table).find("graded"), std::string::npos);
  EXPECT_EQ(report_markdown(report, table).find("raded"), std::string::npos);
}

TEST(Graded, OnlyTiesAreNoAnswers) {
  const TemporaryFolder folder;
  folder.write("a.json", graded_document("p-1", 0, 0).dump());
  EXPECT_THROW(read_answers({folder.path()}, {}), InputError);
}

TEST(Graded, TiesOfMethodsAreTies) {
  const TemporaryFolder folder;
  json document = graded_document("p-1", 0, -3);
  document["plan"]["methods"] = {"pinch", "baseline"};
  folder.write("a.json", document.dump());
  const ComparisonsTable table = read_comparisons({folder.path()}, {});
  EXPECT_EQ(table.answers, 2);
  EXPECT_EQ(table.ties, 1);
}

TEST(Graded, WhereAllAreTiesThatIsSaid) {
  try {
    test::table_of(
        "participant,demonstration,choice,side,preference\na,x,tie,left,0\nb,x,tie,right,0\n");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("all answers are ties"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace pinchlab::analysis
