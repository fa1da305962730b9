// SPDX-License-Identifier: GPL-3.0-or-later
// Confidence and places: against figures by hand, and against what chance may do.
#include <gsl/gsl_randist.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "analysis/besides.h"
#include "analysis/circumstances.h"
#include "analysis/comparisons_table.h"
#include "analysis/gsl_support.h"
#include "analysis/levels_table.h"
#include "analysis/report.h"
#include "base/input_error.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

BesidesAnswer answer_of(const std::string& participant, const std::string& demonstration,
                        const std::string& chosen, int confidence) {
  BesidesAnswer answer;
  answer.participant = participant;
  answer.demonstration = demonstration;
  answer.first = "pinch";
  answer.second = "cable";
  answer.chosen = chosen;
  answer.confidence = confidence;
  return answer;
}

BesidesAnswer hit_of(const std::string& participant, double level, bool is_hit, int confidence) {
  BesidesAnswer answer = answer_of(participant, "squeeze", is_hit ? "pinch" : "cable", confidence);
  answer.level = level;
  answer.is_hit = is_hit;
  return answer;
}

TEST(Besides, ConfidenceInHitsByHand) {
  // a at 0.1: 5 4 4 in hits, 2 4 in misses: of six pairs the hit is surer in 4, and 2 are equal:
  // (4 + 2 / 2) / 6 = 5 / 6; the sure miss at 0.2 is compared with nothing. b: 0. c: 3 / 4. d only
  // hits.
  std::vector<BesidesAnswer> answers;
  for (const int confidence : {5, 4, 4}) answers.push_back(hit_of("a", 0.1, true, confidence));
  for (const int confidence : {2, 4}) answers.push_back(hit_of("a", 0.1, false, confidence));
  answers.push_back(hit_of("a", 0.2, false, 5));
  for (const int confidence : {1, 2}) answers.push_back(hit_of("b", 0.1, true, confidence));
  answers.push_back(hit_of("b", 0.1, false, 3));
  for (const int confidence : {2, 3}) answers.push_back(hit_of("c", 0.2, true, confidence));
  answers.push_back(hit_of("c", 0.2, false, 2));
  answers.push_back(hit_of("d", 0.2, true, 1));
  const Besides besides = analyse_besides(answers, 0.05, 1);
  ASSERT_TRUE(besides.confidence);
  EXPECT_FALSE(besides.places);
  const Confidence& confidence = *besides.confidence;
  EXPECT_NEAR(confidence.area.value, (5.0 / 6 + 0 + 0.75) / 3, 1e-15);
  // R: t.test(c(5/6, 0, .75))$conf.int is -0.6124 to 1.6679, cut to what an area can be.
  EXPECT_EQ(confidence.area_low.value, 0.0);
  EXPECT_EQ(confidence.area_high.value, 1.0);
  EXPECT_EQ(confidence.test.positive, 2U);
  EXPECT_EQ(confidence.test.negative, 1U);
  // Sizes 2/3, 1, 1/2: ranks 2, 3, 1, so W+ = 3 of 6.
  EXPECT_DOUBLE_EQ(confidence.test.w_plus, 3.0);
  ASSERT_EQ(confidence.rows.size(), 3U);
  const ConfidenceRow& lower = confidence.rows.front();
  EXPECT_EQ(lower.name, "squeeze at 0.1");
  EXPECT_EQ(lower.answers, 8U);
  // Participants' means: a 19 / 5, b 2.
  EXPECT_NEAR(lower.mean.value, (3.8 + 2.0) / 2, 1e-15);
  EXPECT_NEAR(lower.mean_with.value, (13.0 / 3 + 1.5) / 2, 1e-15);
  EXPECT_NEAR(lower.mean_against.value, (3.0 + 3.0) / 2, 1e-15);
  // R: t.test(c(3.8, 2))$conf.int
  EXPECT_NEAR(lower.low.value, -8.535584262557, 1e-11);
  EXPECT_NEAR(lower.high.value, 14.335584262557, 1e-11);
  EXPECT_EQ(confidence.rows.back().answers, 13U);
}

TEST(Besides, TheMajorityIsThatOfTheOthers) {
  // Drop: three for pinch, one (d) for cable, one tie. For each of the three the others are 2 : 1
  // for pinch; for d they are 3 : 0. Roll: two against two, so that for each the others are 1 : 2.
  std::vector<BesidesAnswer> answers;
  for (const char* who : {"a", "b", "c"}) answers.push_back(answer_of(who, "drop", "pinch", 4));
  answers.push_back(answer_of("d", "drop", "cable", 1));
  answers.push_back(answer_of("e", "drop", "", 3));
  for (const char* who : {"a", "b"}) answers.push_back(answer_of(who, "roll", "pinch", 2));
  for (const char* who : {"c", "d"}) answers.push_back(answer_of(who, "roll", "cable", 4));
  const Confidence confidence = *analyse_besides(answers, 0.05, 1).confidence;
  const ConfidenceRow& drop = confidence.rows[0];
  EXPECT_EQ(drop.answers, 5U);
  EXPECT_DOUBLE_EQ(drop.mean.value, 16.0 / 5);
  EXPECT_DOUBLE_EQ(drop.mean_with.value, 4.0);
  EXPECT_DOUBLE_EQ(drop.mean_against.value, 1.0);
  const ConfidenceRow& roll = confidence.rows[1];
  EXPECT_FALSE(roll.mean_with) << "each is against the other three";
  EXPECT_DOUBLE_EQ(roll.mean_against.value, 3.0);
  // a and b are surer with the others (1), c as sure (1/2), d has no answer with them.
  EXPECT_DOUBLE_EQ(confidence.area.value, 2.5 / 3);
  EXPECT_EQ(confidence.test.zeros, 1U);
  // Divided others decide nothing.
  const Confidence divided =
      *analyse_besides({answer_of("a", "drop", "pinch", 1), answer_of("b", "drop", "pinch", 2),
                        answer_of("c", "drop", "cable", 3)},
                       0.05, 1)
           .confidence;
  EXPECT_FALSE(divided.area);
  EXPECT_FALSE(divided.test.p);
  EXPECT_FALSE(divided.rows[0].mean_with) << "for a and b the others are 1 : 1";
  EXPECT_DOUBLE_EQ(divided.rows[0].mean_against.value, 3.0);
}

TEST(Besides, LevelsComeInTheirOrder) {
  std::vector<BesidesAnswer> answers;
  for (const double level : {0.5, 0.15, 10.0, 0.05}) answers.push_back(hit_of("a", level, true, 3));
  const Besides besides = analyse_besides(answers, 0.05, 1);
  std::string names;
  for (const ConfidenceRow& row : besides.confidence->rows) names += row.name + "; ";
  EXPECT_EQ(names, "squeeze at 0.05; squeeze at 0.15; squeeze at 0.5; squeeze at 10; all; ");
}

TEST(Besides, TheOrderOfTheAnswersDoesNotMatter) {
  const Rng rng = make_rng(RandomUse::bootstrap, 3);
  std::vector<BesidesAnswer> answers;
  for (int who = 0; who < 12; ++who) {
    for (int item = 0; item < 8; ++item) {
      BesidesAnswer& answer =
          answers.emplace_back(answer_of(fmt::format("p{}", who), fmt::format("{}", item),
                                         gsl_ran_bernoulli(rng.get(), 0.6) != 0 ? "pinch" : "cable",
                                         1 + static_cast<int>(gsl_rng_uniform_int(rng.get(), 7))));
      answer.place = ClickedPlace{item % 3 == 0 ? "pinch" : "cable", gsl_rng_uniform(rng.get()),
                                  gsl_rng_uniform(rng.get()), 0.5};
    }
  }
  nlohmann::ordered_json one, other;
  put_besides(one, analyse_besides(answers, 0.05, 1));
  std::ranges::reverse(answers);
  put_besides(other, analyse_besides(answers, 0.05, 1));
  EXPECT_EQ(one.dump(), other.dump());
}

// Whoever is as sure of every answer says nothing of choices: the test must not claim so, and the
// interval must hold 1/2.
TEST(Besides, ChanceIsFoundAsOftenAsItMay) {
  const Rng rng = make_rng(RandomUse::bootstrap, 5);
  constexpr int studies = 1000;
  int claimed = 0, held = 0;
  for (int study = 0; study < studies; ++study) {
    std::vector<BesidesAnswer> answers;
    for (int who = 0; who < 40; ++who) {
      for (int item = 0; item < 8; ++item) {
        answers.push_back(answer_of(fmt::format("p{}", who), fmt::format("{}", item),
                                    gsl_ran_bernoulli(rng.get(), 0.65) != 0 ? "pinch" : "cable",
                                    1 + static_cast<int>(gsl_rng_uniform_int(rng.get(), 5))));
      }
    }
    const Confidence confidence = *analyse_besides(std::move(answers), 0.05, 1).confidence;
    claimed += confidence.test.p.value < 0.05 ? 1 : 0;
    held += confidence.area_low.value <= 0.5 && 0.5 <= confidence.area_high.value ? 1 : 0;
  }
  EXPECT_LE(claimed, 70) << "of 1000";
  EXPECT_GE(claimed, 25) << "of 1000: the test is not idle";
  EXPECT_GE(held, 930);
  EXPECT_LE(held, 970);
}

TEST(Besides, PlacesByHand) {
  const auto click = [](const std::string& who, const std::string& stimulus,
                        const std::string& clip, double x) {
    BesidesAnswer answer = answer_of(who, stimulus, "pinch", 1);
    answer.confidence.reset();
    if (!clip.empty()) answer.place = ClickedPlace{clip, x, 0.5, 2.0};
    return answer;
  };
  std::vector<BesidesAnswer> answers;
  for (int who = 0; who < 6; ++who) {
    const std::string name = fmt::format("p{}", who);
    answers.push_back(click(name, "drop", "cable", 0.1 * who));
    answers.push_back(click(name, "roll", who == 0 ? "pinch" : "", 0.5));
  }
  const Besides besides = analyse_besides(answers, 0.05, 1);
  EXPECT_FALSE(besides.confidence);
  const Places& places = *besides.places;
  EXPECT_EQ(places.answers, 12U);
  EXPECT_EQ(places.clicks, 7U);
  EXPECT_EQ(places.first, "cable");
  EXPECT_EQ(places.on_first, 6U);
  EXPECT_EQ(places.on_second, 1U);
  // Scores 0, 1, 1, 1, 1, 1: all of one sign, 2 / 2^5.
  EXPECT_DOUBLE_EQ(places.p_sign_flip.value, 0.0625);
  ASSERT_EQ(places.rows.size(), 4U);
  EXPECT_EQ(places.rows[0].stimulus, "drop");
  EXPECT_EQ(places.rows[0].clip, "cable");
  EXPECT_EQ(places.rows[0].shown, 6U);
  EXPECT_EQ(places.rows[0].participants, 6U);
  EXPECT_TRUE(places.rows[1].clicks.empty());
  nlohmann::ordered_json document;
  put_besides(document, besides);
  EXPECT_DOUBLE_EQ(document["places"]["rows"][0]["x_median"].get<double>(), 0.25);
  const std::vector<CsvTable> tables = besides_csv(besides);
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_EQ(std::ranges::count(tables[0].content, '\n'), 8);
  EXPECT_EQ(besides_figures(besides).size(), 1U);
  // Three kinds of clips have a table, and no test of two.
  answers[0].second = answers[0].place->clip = "thesis";
  EXPECT_FALSE(analyse_besides(answers, 0.05, 1).places->p_sign_flip);
}

// Two participants who are asked besides, of any kind of study.
json asked_document(const std::string& participant, int confidence) {
  json document = test::answer_document(participant);
  for (json& trial : document["trials"]) {
    trial["confidence"] = confidence;
    trial.update(
        {{"where_side", "left"}, {"where_x", 0.25}, {"where_y", 0.75}, {"where_time_s", 1.5}});
  }
  return document;
}

TEST(Besides, StandInEveryReport) {
  const TemporaryFolder folder;
  for (const char* kind : {"two", "methods", "levels"}) {
    for (const char* who : {"p-1", "p-2"}) {
      json document = asked_document(who, who[2] - '0');
      if (kind == std::string("methods")) document["plan"]["methods"] = {"pinch", "baseline"};
      if (kind == std::string("levels")) {
        document["plan"]["graded_hit"] = "reference";
        for (json& trial : document["trials"]) {
          if (trial["kind"] == "attention") {
            trial["left"] = trial["right"] = "check";
            continue;
          }
          const bool is_left = trial["left"] == "pinch";
          trial["left"] = is_left ? "reference" : "graded";
          trial["right"] = is_left ? "graded" : "reference";
          trial["level"] = 0.5;
        }
      }
      std::filesystem::create_directories(folder.path() / kind);
      folder.write(fmt::format("{}/{}.json", kind, who), document.dump());
    }
  }
  ReadOptions named;
  named.pinch_value = "ours";
  const AnswersTable two = read_answers({folder.path() / "two"}, named);
  ASSERT_EQ(two.besides.size(), 4U) << "of main trials only";
  EXPECT_EQ(two.besides[0].place->clip, "cable") << "the clip on the left, by the name in reports";
  EXPECT_EQ(two.besides[1].place->clip, "ours");
  const Report report = analyse_table(two, {.bootstrap = 99});
  EXPECT_EQ(report.circumstances.checks_passed, 2);
  EXPECT_EQ(report.circumstances.frames, 2 * 4 * 900);
  EXPECT_EQ(report.circumstances.screens.at({1920, 1080}), 2);
  EXPECT_EQ(report.circumstances.narrowest_clips_px, 1800);
  const std::string markdown = report_markdown(report, two);
  for (const char* words :
       {"Confidence", "Where it looks wrong", "2 of 1920 × 1080", "dropped frames of 7200 (0.11 %)",
        "Both clips together were 1800 wide"}) {
    EXPECT_NE(markdown.find(words), std::string::npos) << words;
  }
  const json data = json::parse(report_json(report, two));
  EXPECT_DOUBLE_EQ(data["confidence"]["rows"].back()["mean"], 1.5);
  EXPECT_EQ(data["places"]["clicks"], 4);
  EXPECT_EQ(read_comparisons({folder.path() / "methods"}, {}).besides.size(), 4U);
  const LevelsTable levels = read_levels({folder.path() / "levels"}, {});
  ASSERT_EQ(levels.besides.size(), 4U);
  EXPECT_EQ(stimulus_of(levels.besides[0]), "07-driven-roller at 0.5");
  EXPECT_EQ(levels.besides[0].is_hit, false);
  EXPECT_EQ(levels.besides[1].is_hit, true);
  EXPECT_EQ(levels.sessions.size(), 2U);
}

TEST(Besides, NothingIsSaidWhereNothingWasAsked) {
  const TemporaryFolder folder;
  folder.write("a.json", test::answer_document("p-1").dump());
  const AnswersTable table = read_answers({folder.path()}, {});
  const Report report = analyse_table(table, {.bootstrap = 99});
  EXPECT_TRUE(report.besides.answers.empty());
  EXPECT_EQ(report_json(report, table).find("\"confidence\""), std::string::npos);
  EXPECT_EQ(report_markdown(report, table).find("looks wrong"), std::string::npos);
}

}  // namespace
}  // namespace pinchlab::analysis
