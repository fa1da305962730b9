// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated participants over HTTP, by the program: plan, server, answers, statistics, and the
// truth had back.
#include "study/simulate.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <map>
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
  for (const char* key : {"demonstrations", "pooled", "side_bias", "order_effect", "answer"})
    EXPECT_EQ(again[key], report[key]) << key;
  EXPECT_TRUE(again["answer"].get<std::string>().starts_with("Answers of a pilot. "));
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
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Truth truth;
  truth.shares = {{"01-fisrt", 0.9}};
  EXPECT_EQ(why(truth),
            "truth: /shares/01-fisrt: the study has no demonstration of this name (did you mean "
            "`01-first`?)");
  truth.shares = {{"01-first", 0.9}};
  EXPECT_EQ(why(truth), "");
  truth.methods = {{"pinch", 1.0}};
  EXPECT_EQ(why(truth), "truth: /methods/pinch: the study has no method of this name");
  truth.methods.clear();
  truth.series["squeeze"];
  EXPECT_EQ(why(truth), "truth: /series/squeeze: the study has no series of this name");
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
  EXPECT_THROW(simulate(desk, Truth{}, SimulationOptions{}), InputError);
}

// By number, all that a participant answered: names and times are new in each run.
std::map<int, std::string> answers_by_number(const fs::path& answers) {
  std::map<int, std::string> all;
  for (const fs::path& path : answer_files(answers)) {
    json file = read_answer_json(path);
    for (json& trial : file["trials"]) trial.erase("shown_utc");
    EXPECT_TRUE(all.emplace(file["participant_number"], file["trials"].dump()).second);
  }
  return all;
}

TEST(Simulate, AnInterruptedRunIsContinuedToTheSameAnswers) {
  const fs::path folder = scratch_folder();
  write_clips(folder / "clips");
  write_text(folder / "study.json",
             json{{"format", "pinchlab-study 1"}, {"demonstrations", demonstrations}}.dump());
  write_text(folder / "truth.json", json{{"format", "pinchlab-truth 1"}, {"spread", 1}}.dump());
  const std::string line = "study simulate --clips clips --truth truth.json --config study.json ";
  run(folder, line + "--answers whole --participants 6 --seed 4");
  const std::map<int, std::string> whole = answers_by_number(folder / "whole");
  ASSERT_EQ(whole.size(), 6U);
  // As if killed: two have finished, and one has answered a part.
  run(folder, line + "--answers parts --participants 2 --seed 4");
  {
    DeskOptions options = desk_options(folder);
    options.answers = folder / "parts";
    options.seed = 4;
    options.config.is_pilot = true;
    options.config.simulated_by = read_truth(folder / "truth.json").sha256;
    Desk desk(std::move(options));
    const std::string token = desk.start("", "browser");
    desk.show(token, 0);
    desk.answer(token, parse_answer(answer_body(0)));
  }
  run(folder, line + "--answers parts --participants 6 --seed 4");
  EXPECT_EQ(answers_by_number(folder / "parts"), whole);
  EXPECT_EQ(read_whole(folder / "out.txt"),
            "6 simulated participants, 2 of them from before; answers in parts\n");
  run(folder, line + "--answers parts --participants 6 --seed 4");
  EXPECT_EQ(answers_by_number(folder / "parts"), whole);
}

// Runs the program, which has to fail with this exit code; what it says.
std::string refusal(const fs::path& folder, const std::string& command, int exit_code) {
  const std::string line = "cd '" + folder.string() + "' && '" + PINCHLAB_PROGRAM + "' " + command +
                           " > out.txt 2> err.txt";
  const int status = std::system(line.c_str());
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == exit_code) << command;
  EXPECT_EQ(read_whole(folder / "out.txt"), "");
  return read_whole(folder / "err.txt");
}

TEST(Simulate, AFolderHoldsAnswersByOneTruth) {
  const fs::path folder = scratch_folder();
  write_clips(folder / "clips");
  write_text(folder / "study.json",
             json{{"format", "pinchlab-study 1"}, {"demonstrations", demonstrations}}.dump());
  write_text(folder / "truth.json", json{{"format", "pinchlab-truth 1"}}.dump());
  write_text(folder / "other.json", json{{"format", "pinchlab-truth 1"}, {"left", 1}}.dump());
  write_text(folder / "wrong.json",
             json{{"format", "pinchlab-truth 1"}, {"shares", {{"01-fisrt", 0.9}}}}.dump());
  const std::string line =
      "study simulate --clips clips --config study.json --participants 2 --answers ";
  run(folder, line + "answers --truth truth.json --seed 4");
  EXPECT_EQ(refusal(folder, line + "answers --truth other.json --seed 4", 1),
            "answers: was simulated by another truth; use another --answers\n");
  EXPECT_EQ(refusal(folder, line + "answers --truth truth.json", 1),
            "answers: the study in this folder has the seed 4, not 1; say --seed 4, or use another "
            "--answers\n");
  EXPECT_EQ(refusal(folder, line + "new --truth wrong.json", 1),
            "wrong.json: /shares/01-fisrt: the study has no demonstration of this name (did you "
            "mean `01-first`?)\n");
  EXPECT_FALSE(fs::exists(folder / "new"));
  // People in a trial run are nobody's simulation.
  DeskOptions options = desk_options(folder);
  options.config.is_pilot = true;
  options.seed = 4;
  EXPECT_THROW(Desk{std::move(options)}, std::runtime_error);
  options = desk_options(folder);
  options.config.is_pilot = true;
  options.answers = folder / "people";
  { Desk desk(std::move(options)); }
  for (const char* seed : {"7", "8"}) {
    EXPECT_EQ(refusal(folder, line + "people --truth truth.json --seed " + seed, 1),
              "people: is not of simulated participants; use another --answers\n");
  }
}

}  // namespace
}  // namespace pinchlab::study
