// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated participants over HTTP, by the program: plan, server, answers, statistics, and the
// truth had back.
#include "study/simulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Runs the program and expects that it succeeds.
void run(const fs::path& folder, const std::string& command) {
  const std::string line = "cd '" + folder.string() + "' && '" + PINCHLAB_PROGRAM + "' " + command +
                           " > out.txt 2> err.txt";
  ASSERT_EQ(std::system(line.c_str()), 0) << command << "\n" << read_whole(folder / "err.txt");
}

json report_of(const fs::path& folder, const std::string& simulate, const std::string& analyse) {
  run(folder,
      "study simulate --clips clips --answers answers --truth truth.json --config study.json " +
          simulate);
  run(folder, "analyse answers --no-figures --out report " + analyse);
  return json::parse(read_whole(folder / "report" / "report.json"));
}

// The same answers under other names of participants: equal counts, and sums in another order.
void expect_same_answers(const json& one, const json& other) {
  ASSERT_EQ(one["pairs"].size(), other["pairs"].size());
  for (std::size_t i = 0; i < one["pairs"].size(); ++i) {
    for (const char* key : {"first", "second", "first_wins", "second_wins"})
      EXPECT_EQ(one["pairs"][i][key], other["pairs"][i][key]) << key;
    EXPECT_NEAR(one["pairs"][i]["p"].get<double>(), other["pairs"][i]["p"].get<double>(), 1e-9);
  }
  EXPECT_EQ(one["transitivity"]["circular_triads"], other["transitivity"]["circular_triads"]);
}

// The exported CSV gives analysis/reproduce.R, where there is R, the same function.
void expect_reproduced(const fs::path& folder, const json& series) {
  if (std::system("Rscript --version > /dev/null 2>&1") != 0) return;
  const std::string line = std::string("Rscript --vanilla '") + PINCHLAB_SOURCE_DIR +
                           "/analysis/reproduce.R' '" + (folder / "answers.csv").string() +
                           "' 2> /dev/null > '" + (folder / "r.csv").string() + "'";
  ASSERT_EQ(std::system(line.c_str()), 0);
  std::istringstream text(read_whole(folder / "r.csv"));
  std::string names, cells, cell;
  std::getline(text, names);
  std::getline(text, cells);
  ASSERT_EQ(names, "series,answers,threshold,width,lapse,spread");
  std::istringstream row(cells);
  std::getline(row, cell, ',');
  EXPECT_EQ(cell, series["name"]);
  for (const char* key : {"answers", "threshold", "width", "lapse", "spread"}) {
    std::getline(row, cell, ',');
    EXPECT_NEAR(std::stod(cell), series[key].get<double>(), 2e-4) << key;
  }
}

const std::vector<std::string> methods = {"pinch", "nocontact", "cable", "thesis"};

void write_methods_study(const fs::path& folder, const json& truth) {
  fs::create_directories(folder / "clips");
  for (const std::string demonstration : {"01-a", "02-b", "03-c"}) {
    for (const std::string& left : methods) {
      for (const std::string& right : methods) {
        if (left != right)
          write_text(folder / "clips" / comparison_file(demonstration, left, right, "mp4"),
                     demonstration + left + right);
      }
    }
  }
  write_text(folder / "study.json", json{{"format", "pinchlab-study 1"},
                                         {"demonstrations", {"01-a", "02-b", "03-c"}},
                                         {"methods", methods}}
                                        .dump());
  write_text(folder / "truth.json", truth.dump());
}

TEST(Simulate, AStudyOfFourMethodsFindsTheirScale) {
  const fs::path folder = scratch_folder();
  const json truth = {
      {"format", "pinchlab-truth 1"},
      {"methods", {{"pinch", 0.9}, {"thesis", 0.3}, {"nocontact", -0.4}, {"cable", -0.8}}},
      {"spread", 0.3},
      {"left", 0.2}};
  write_methods_study(folder, truth);
  const json report = report_of(folder, "--participants 40 --seed 3", "");
  EXPECT_TRUE(report["answer"].get<std::string>().starts_with("Answers of a pilot. The methods"));
  EXPECT_EQ(report["playback"]["screens"][0]["participants"], 40);
  EXPECT_EQ(report["participants"], 40);
  EXPECT_EQ(report["answers"], 40 * 18);
  for (const json& method : report["scale"]["methods"]) {
    const double value = truth["methods"][method["name"].get<std::string>()];
    EXPECT_LE(method["low"].get<double>(), value) << method;
    EXPECT_GE(method["high"].get<double>(), value) << method;
    EXPECT_NEAR(method["value"].get<double>(), value, 0.35);
  }
  EXPECT_LT(report["equal"]["p_sign_flip"].get<double>(), 0.001);
  EXPECT_GT(report["demonstrations_differ"]["p"].get<double>(), 0.001);
  EXPECT_EQ(report["transitivity"]["rounds"], 120);
  EXPECT_NEAR(report["left"]["value"].get<double>(), 0.2, 0.25);
  for (const fs::path& path : answer_files(folder / "answers")) {
    EXPECT_EQ(json::parse(read_whole(path))["pilot"], true);
  }
  // The same seed gives the same answers, whoever comes first; the export reads back to the same.
  fs::remove_all(folder / "answers");
  expect_same_answers(report_of(folder, "--participants 40 --seed 3", ""), report);
  run(folder, "study export --answers answers --csv answers.csv");
  run(folder, "analyse answers.csv --no-figures --out again");
  expect_same_answers(json::parse(read_whole(folder / "again/report.json")), report);
}

TEST(Simulate, AnIncompleteDesignFindsTheScaleToo) {
  const fs::path folder = scratch_folder();
  const json truth = {{"format", "pinchlab-truth 1"},
                      {"methods", {{"pinch", 1}, {"thesis", 0}, {"nocontact", 0}, {"cable", -1}}}};
  write_methods_study(folder, truth);
  json config = json::parse(read_whole(folder / "study.json"));
  config["pairs_per_demonstration"] = 2;
  write_text(folder / "study.json", config.dump());
  const json report = report_of(folder, "--participants 120 --seed 8", "");
  EXPECT_EQ(report["answers"], 120 * 6);
  for (const json& method : report["scale"]["methods"]) {
    EXPECT_NEAR(method["value"].get<double>(),
                truth["methods"][method["name"].get<std::string>()].get<double>(), 0.35);
  }
  EXPECT_EQ(report["transitivity"]["rounds"], 0);
}

TEST(Simulate, AStudyOfThresholdsFindsTheThreshold) {
  const fs::path folder = scratch_folder();
  fs::create_directories(folder / "clips");
  json clips = json::array();
  for (const double level : {0.05, 0.1, 0.15, 0.2, 0.25, 0.3}) {
    const std::string name = "squeeze-" + std::to_string(std::lround(100 * level));
    for (const char* side : {"left", "right"})
      write_text(folder / "clips" / (name + "-" + side + ".mp4"), name + side);
    clips.push_back(
        {{"level", level}, {"left", name + "-left.mp4"}, {"right", name + "-right.mp4"}});
  }
  write_text(folder / "study.json", json{{"format", "pinchlab-study 1"},
                                         {"series", {{{"name", "squeeze"}, {"clips", clips}}}},
                                         {"repetitions", 6}}
                                        .dump());
  write_text(
      folder / "truth.json",
      json{{"format", "pinchlab-truth 1"},
           {"series", {{"squeeze", {{"threshold", 0.16}, {"width", 0.15}, {"spread", 0.02}}}}},
           {"lapses", 0.02}}
          .dump());
  const json report = report_of(folder, "--participants 40 --seed 5", "--bootstrap 99");
  EXPECT_EQ(report["format"], "pinchlab-thresholds");
  const json& series = report["series"][0];
  EXPECT_EQ(series["participants"], 40);
  EXPECT_EQ(series["answers"], 40 * 36);
  EXPECT_EQ(series["levels"].size(), 6U);
  EXPECT_LE(series["threshold_low"].get<double>(), 0.16);
  EXPECT_GE(series["threshold_high"].get<double>(), 0.16);
  EXPECT_NEAR(series["threshold"].get<double>(), 0.16, 0.02);
  EXPECT_NEAR(series["width"].get<double>(), 0.15, 0.06);
  EXPECT_NEAR(series["spread"].get<double>(), 0.02, 0.02);
  run(folder, "study export --answers answers --csv answers.csv");
  expect_reproduced(folder, series);
  run(folder, "analyse answers.csv --no-figures --bootstrap 99 --out again");
  EXPECT_EQ(json::parse(read_whole(folder / "again/report.json"))["series"][0]["threshold"],
            series["threshold"]);
}

TEST(Simulate, AStudyOfTwoMethodsFindsTheShares) {
  const fs::path folder = scratch_folder();
  write_clips(folder / "clips");
  write_text(folder / "study.json",
             json{{"format", "pinchlab-study 1"}, {"demonstrations", demonstrations}}.dump());
  write_text(folder / "truth.json", json{{"format", "pinchlab-truth 1"},
                                         {"shares", {{"01-first", 0.85}, {"03-third", 0.3}}}}
                                        .dump());
  const json report = report_of(folder, "--participants 200 --seed 2", "--bootstrap 199");
  const double truth[] = {0.85, 0.5, 0.3};
  for (std::size_t i = 0; i < 3; ++i) {
    const json& row = report["demonstrations"][i];
    EXPECT_LE(row["clopper_pearson_low"].get<double>(), truth[i]) << row["name"];
    EXPECT_GE(row["clopper_pearson_high"].get<double>(), truth[i]) << row["name"];
  }
  run(folder, "study export --answers answers --csv answers.csv");
  run(folder, "analyse answers.csv --no-figures --bootstrap 199 --out again");
  const json again = json::parse(read_whole(folder / "again/report.json"));
  for (const char* key : {"demonstrations", "pooled", "side_bias", "order_effect"})
    EXPECT_EQ(again[key], report[key]) << key;
}

// Whatever is asked besides the choice: the table of answers reads back.
TEST(Simulate, TheExportOfAllThatCanBeAskedIsRead) {
  const fs::path folder = scratch_folder();
  write_clips(folder / "clips");
  write_text(folder / "study.json",
             json{{"format", "pinchlab-study 1"},
                  {"demonstrations", demonstrations},
                  {"training", {"01-first"}},
                  {"preference", "graded"},
                  {"confidence", 5},
                  {"reason", 100},
                  {"click_where", true},
                  {"questionnaire_before", json::array({{{"name", "age"},
                                                         {"kind", "number"},
                                                         {"text", "How old are you?"},
                                                         {"min", 18},
                                                         {"max", 120}}})}}
                 .dump());
  write_text(folder / "truth.json", json{{"format", "pinchlab-truth 1"}}.dump());
  const json report = report_of(folder, "--participants 40 --seed 2", "--bootstrap 99");
  ASSERT_TRUE(report.contains("graded_preferences"));
  run(folder, "study export --answers answers --csv answers.csv");
  EXPECT_NE(read_whole(folder / "answers.csv").find(",tie,"), std::string::npos);
  run(folder, "analyse answers.csv --no-figures --bootstrap 99 --out again");
  const json again = json::parse(read_whole(folder / "again/report.json"));
  for (const char* key : {"demonstrations", "pooled", "graded_preferences"})
    EXPECT_EQ(again[key], report[key]) << key;
}

TEST(Simulate, LogsHaveNoLinesThatAreWrittenAnew) {
  const fs::path folder = scratch_folder();
  write_clips(folder / "clips");
  write_text(folder / "study.json",
             json{{"format", "pinchlab-study 1"}, {"demonstrations", demonstrations}}.dump());
  write_text(folder / "truth.json", json{{"format", "pinchlab-truth 1"}}.dump());
  run(folder,
      "study simulate --clips clips --answers answers --truth truth.json --config study.json "
      "--participants 3");
  EXPECT_EQ(read_whole(folder / "err.txt").find('\r'), std::string::npos);
}

TEST(Simulate, NamesThatTheStudyDoesNotHaveAreRefused) {
  const fs::path folder = scratch_folder();
  Desk desk(desk_options(folder));
  const auto why = [&](const Truth& truth) -> std::string {
    try {
      simulate(desk, truth, {});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  Truth truth;
  truth.shares = {{"01-fisrt", 0.9}};
  EXPECT_EQ(why(truth),
            "the truth's `shares`: the study has no demonstration `01-fisrt` (did you mean "
            "`01-first`?)");
  truth.shares = {{"01-first", 0.9}};
  EXPECT_EQ(why(truth), "");
  truth.methods = {{"pinch", 1.0}};
  EXPECT_EQ(why(truth), "the truth's `methods`: the study has no method `pinch`");
  truth.methods.clear();
  truth.series["squeeze"];
  EXPECT_EQ(why(truth), "the truth's `series`: the study has no series `squeeze`");
}

TEST(Simulate, TruthsAreCheckedWholly) {
  const fs::path folder = scratch_folder();
  const auto why = [&](const json& truth) -> std::string {
    write_text(folder / "truth.json", truth.dump());
    try {
      read_truth(folder / "truth.json");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const json good = {{"format", "pinchlab-truth 1"}};
  EXPECT_EQ(why(good), "");
  for (const auto& [key, value] : {std::pair<const char*, json>{"shares", {{"a", 1}}},
                                   {"methods", {{"a", "b"}}},
                                   {"series", {{"a", {{"threshold", 1}}}}},
                                   {"lapses", 2},
                                   {"spraed", 1}}) {
    json bad = good;
    bad[key] = value;
    EXPECT_NE(why(bad), "") << key;
  }
  DeskOptions options = desk_options(folder);
  options.config.methods = {"a", "b", "c"};
  options.config.demonstrations = {"x"};
  Desk desk(std::move(options));
  EXPECT_THROW(simulate(desk, Truth{}, SimulationOptions{}), std::invalid_argument);
}

}  // namespace
}  // namespace pinchlab::study
