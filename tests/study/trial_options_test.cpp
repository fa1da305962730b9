// SPDX-License-Identifier: GPL-3.0-or-later
// What a study asks in each trial besides the choice.
#include "study/session.h"

#include "analysis/comparisons_table.h"
#include "analysis/pages.h"
#include "analysis/report.h"
#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "study/answers.h"
#include "study/results.h"
#include "study/shown.h"
#include "study/simulate.h"
#include "study/tables.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Config config_with(const json& more) {
  json document = {{"format", "pinchlab-study 1"}, {"demonstrations", demonstrations}};
  document.update(more);
  return parse_config(document, "study.json");
}

const json everything = {
    {"confidence", 5}, {"preference", "graded"}, {"reason", 20}, {"click_where", true}};

DeskOptions asking_desk(const fs::path& folder, const json& more = everything) {
  DeskOptions options = desk_options(folder);
  options.config = config_with(more);
  return options;
}

json full_body(std::size_t index, int preference) {
  json body = answer_body(index, preference < 0 ? "left" : preference > 0 ? "right" : "tie");
  body.update({{"preference", preference},
               {"confidence", 4},
               {"reason", "=A1"},
               {"where_side", "right"},
               {"where_x", 0.25},
               {"where_y", 1},
               {"where_time_s", 1.5}});
  return body;
}

TEST(TrialOptions, ErrorsNamePlaceAndCure) {
  const std::vector<std::pair<json, const char*>> bad = {
      {{{"confidence", 1}}, "/confidence: must be a whole number from 2 to 9"},
      {{{"confidence", true}}, "/confidence"},
      {{{"preference", "gradual"}}, "/preference"},
      {{{"reason", 0}}, "/reason: must be a whole number from 1 to 2000"},
      {{{"reason", true}}, "/reason"},
      {{{"click_where", 1}}, "/click_where: must be true or false"},
  };
  for (const auto& [more, message] : bad) {
    try {
      config_with(more);
      ADD_FAILURE() << more << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
  const json clip = {{"level", 0.1}, {"left", "a.mp4"}, {"right", "b.mp4"}};
  const json other = {{"level", 0.2}, {"left", "c.mp4"}, {"right", "d.mp4"}};
  const json series = {{"format", "pinchlab-study 1"},
                       {"preference", "graded"},
                       {"series", json::array({{{"name", "s"}, {"clips", {clip, other}}}})}};
  EXPECT_THROW(parse_config(series, "study.json"), InputError);
}

TEST(TrialOptions, BodiesAreChecked) {
  const auto status = [](const char* key, const json& value) {
    json body = full_body(0, 2);
    body[key] = value;
    return refused([&] { parse_answer(body); });
  };
  EXPECT_EQ(refused([] { parse_answer(full_body(0, 0)); }), 0);
  for (const auto& [key, value] : std::vector<std::pair<const char*, json>>{{"preference", 4},
                                                                            {"preference", -1},
                                                                            {"preference", 0},
                                                                            {"preference", 1.5},
                                                                            {"preference", "2"},
                                                                            {"choice", "tie"},
                                                                            {"choice", "left"},
                                                                            {"confidence", 0},
                                                                            {"confidence", 10},
                                                                            {"confidence", "5"},
                                                                            {"reason", ""},
                                                                            {"reason", 5},
                                                                            {"where_side", "both"},
                                                                            {"where_x", 1.01},
                                                                            {"where_x", -0.01},
                                                                            {"where_y", "0"},
                                                                            {"where_time_s", -1}}) {
    EXPECT_EQ(status(key, value), 422) << key << " " << value;
  }
  for (const char* key : {"where_side", "where_x", "where_y", "where_time_s"}) {
    json body = full_body(0, 2);
    body.erase(key);
    EXPECT_EQ(refused([&] { parse_answer(body); }), 422) << key << " missing";
  }
  json tie = answer_body(0, "tie");
  EXPECT_EQ(refused([&] { parse_answer(tie); }), 422) << "a tie without a grade";
}

TEST(TrialOptions, WhatIsAskedIsAnsweredAndNothingElse) {
  const auto status = [](const json& options, json body) {
    return refused([&] { check_asked(parse_answer(body).answer, config_with(options).trial); });
  };
  EXPECT_EQ(status(everything, full_body(0, -3)), 0);
  EXPECT_EQ(status(json::object(), answer_body(0)), 0);
  for (const char* key : {"preference", "confidence", "reason"}) {
    json body = full_body(0, 1);
    body.erase(key);
    EXPECT_EQ(status(everything, body), std::string(key) == "reason" ? 0 : 422) << key;
    json options = everything;
    options.erase(key);
    EXPECT_EQ(status(options, full_body(0, 1)), 422) << key << " was not asked";
  }
  json options = everything;
  options["click_where"] = false;
  EXPECT_EQ(status(options, full_body(0, 1)), 422);
  json body = full_body(0, 1);
  body["confidence"] = 6;
  EXPECT_EQ(status(everything, body), 422) << "beyond the scale";
  body = full_body(0, 1);
  body["reason"] = std::string(81, 'x');
  EXPECT_EQ(status(everything, body), 422) << "longer than can be written";
}

TEST(TrialOptions, AnswersAreKeptAndExported) {
  const fs::path folder = scratch_folder();
  {
    Desk desk(asking_desk(folder));
    const std::string token = desk.start("", "");
    desk.show(token, 0);
    EXPECT_EQ(refused([&] { desk.answer(token, parse_answer(answer_body(0))); }), 422);
    desk.answer(token, parse_answer(full_body(0, -2)));
    desk.answer(token, parse_answer(full_body(0, -2)));  // sent again
    EXPECT_EQ(refused([&] { desk.answer(token, parse_answer(full_body(0, -1))); }), 409);
  }
  Desk desk(asking_desk(folder));
  const std::string id = desk.overview().running.front().id;
  desk.release(id);
  const std::string token = desk.start("", "");
  for (std::size_t i = 0; i < demonstrations.size(); ++i) {
    desk.show(token, i);
    desk.answer(token, parse_answer(full_body(i, static_cast<int>(i) - 1)));
  }
  desk.save(token, {});
  const json file = json::parse(read_whole(answer_files(folder / "answers").front()));
  EXPECT_EQ(file["trials"][0]["choice"], "left");
  EXPECT_EQ(file["trials"][1]["choice"], "tie");
  EXPECT_EQ(file["trials"][1]["preference"], 0);
  EXPECT_EQ(file["trials"][2]["confidence"], 4);
  EXPECT_EQ(parse_answer_file(file, "file").trials[1].choice, pinchlab::Side::unknown);
  const std::string csv = answers_csv(folder / "answers");
  EXPECT_NE(csv.find(",preference,confidence,reason,where_side,where_x,where_y,where_time_s\n"),
            std::string::npos);
  EXPECT_NE(csv.find(",0,4,'=A1,right,0.25,1.0,1.5\n"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",tie,tie,"), std::string::npos);
  const json read = Results(folder / "answers").read(true);
  EXPECT_EQ(read["sides"], (json{{"left", 1}, {"right", 1}})) << "a tie is on neither side";
  int ties = 0;
  for (const json& row : read["demonstrations"]) ties += row["chosen"].value("tie", 0);
  EXPECT_EQ(ties, 1);
}

TEST(TrialOptions, OtherOptionsAreAnotherStudy) {
  const fs::path folder = scratch_folder();
  { Desk desk(asking_desk(folder)); }
  json other = everything;
  other["confidence"] = 7;
  EXPECT_THROW(Desk desk(asking_desk(folder, other)), std::runtime_error);
  for (const auto& [key, text] : config_with({{"preference", "forced"}}).texts) {
    for (const char* option : {"graded_", "confidence_", "click_", "reason_"}) {
      EXPECT_FALSE(key.starts_with(option)) << key;
    }
  }
}

// What the README marks with `?` can be left out of an answer, and nothing else.
TEST(TrialOptions, EveryKeyOfAnAnswerIsDocumented) {
  const std::string readme = read_whole(fs::path(PINCHLAB_SOURCE_DIR) / "study/README.md");
  const std::size_t begin = readme.find("Keys of `POST /api/answer`");
  ASSERT_NE(begin, std::string::npos);
  const std::string keys = readme.substr(begin, readme.find("\n\nAny request", begin) - begin);
  json whole = answer_body(0);
  whole.update({{"reason", "jumps"},
                {"where_side", "left"},
                {"where_x", 0.5},
                {"where_y", 0.5},
                {"where_time_s", 1}});
  for (const auto& [key, value] : whole.items()) {
    json without = whole;
    without.erase(key);
    const bool may_be_left_out = refused([&] { parse_answer(without); }) == 0;
    EXPECT_NE(keys.find("`" + key + (may_be_left_out ? "?`" : "`")), std::string::npos) << key;
  }
}

// Simulated grades: the truth's sign is found again, ties are reported and in no count.
TEST(TrialOptions, SimulatedGradesAreAnalysed) {
  const fs::path folder = scratch_folder();
  write_text(folder / "truth.json",
             R"({"format": "pinchlab-truth 1", "shares": {"01-first": 0.9, "02-second": 0.9}})");
  {
    Desk desk(asking_desk(folder));
    simulate(desk, read_truth(folder / "truth.json"),
             {.participants = 60, .seed = 5, .begin = {}, .progress = {}});
  }
  const analysis::AnswersTable table = analysis::read_answers({folder / "answers"}, {});
  const analysis::Report report = analysis::analyse_table(table, {.bootstrap = 99});
  ASSERT_EQ(report.graded.size(), demonstrations.size() + table.groups.size());
  const analysis::GradedPreference& all = report.graded.back();
  EXPECT_EQ(all.answers, 180U);
  EXPECT_EQ(all.participants, 60U);
  EXPECT_GT(all.ties, 5U);
  EXPECT_LT(all.ties, 35U);
  EXPECT_EQ(static_cast<std::int64_t>(all.answers - all.ties), report.all().row.counts.total());
  EXPECT_GT(report.graded[0].mean, 1);
  EXPECT_LT(report.graded[0].test.p.value, 1e-6);
  EXPECT_GT(report.graded[2].test.p.value, 1e-4) << "no preference there";
  EXPECT_TRUE(table.incomplete.empty()) << "who gave ties has answered";
  EXPECT_NE(markdown_page(make_document(report, table), {}).find("of 180 answers were ties"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::study
