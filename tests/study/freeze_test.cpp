// SPDX-License-Identifier: GPL-3.0-or-later
// The frozen design: what it fixes, what it refuses, and what the analysis says of it.
#include "study/freeze.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "base/strict_json.h"
#include "study/utc.h"
#include "tests/base/message_of.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using pinchlab::test::message_of;

const json good_rules = {{"format", "pinchlab-rules 1"},
                         {"hypotheses", {"Pinch joints look more realistic."}},
                         {"exclusions", {{"focus_lost_over", 5}, {"clip_width_px_under", 600}}},
                         {"analysis", {{"alpha", 0.01}, {"bootstrap", 199}}}};

FreezeOptions freeze_options(const fs::path& folder, const json& rules = good_rules) {
  DeskOptions desk = desk_options(folder);
  FreezeOptions options;
  options.config = desk.config;
  options.clips = std::move(desk.clips);
  options.answers = folder / "answers";
  options.seed = 7;
  options.sample.looks = {3};
  options.rules = parse_rules(rules, "rules.json", AnswersKind::two_methods);
  options.out = folder / "out";
  options.utc = "2020-01-02T03:04:05Z";
  return options;
}

// What `analyse` says in report.json; its words in `words`.
json design_in_report(const fs::path& folder, const std::string& more,
                      std::string* words = nullptr) {
  const std::string line = "cd '" + folder.string() + "' && '" + PINCHLAB_PROGRAM +
                           "' analyse answers --no-figures --out report " + more +
                           " > out.txt 2> err.txt";
  EXPECT_EQ(std::system(line.c_str()), 0) << read_whole(folder / "err.txt");
  const json report = json::parse(read_whole(folder / "report" / "report.json"));
  if (words != nullptr) *words = report["answer"];
  EXPECT_NE(read_whole(folder / "report" / "report.md").find("SHA-256"), std::string::npos);
  return report["design"];
}

void take_part_in(const fs::path& folder, int participants, const json& changes = json::object()) {
  Desk desk(desk_options(folder));
  for (int i = 0; i < participants; ++i) {
    take_part(desk, [&](json& body) {
      body["clip_width_px"] = 1000;
      body.update(changes);
    });
  }
}

TEST(Freeze, WhatFollowsTheDesignIsSaidToFollowIt) {
  const fs::path folder = scratch_folder();
  const std::string hash = freeze(freeze_options(folder));
  take_part_in(folder, 3);
  take_part_in(folder, 1, {{"focus_lost_count", 2}});  // 6 in three trials: a rule leaves it out
  std::string words;
  const json design = design_in_report(folder, "", &words);
  EXPECT_EQ(design["sha256"], hash);
  EXPECT_EQ(design["followed"], true) << design;
  EXPECT_EQ(design["deviations"], json::array());
  EXPECT_NE(words.find("was followed"), std::string::npos);
  const json report = json::parse(read_whole(folder / "report" / "report.json"));
  EXPECT_EQ(report["alpha"], 0.01);  // the design's, not the usual one
  ASSERT_EQ(report["input"]["excluded"].size(), 1U);
  EXPECT_NE(
      report["input"]["excluded"][0]["reason"].get<std::string>().find("more than 5 times: 6"),
      std::string::npos);
}

TEST(Freeze, EachDeviationIsNamed) {
  const fs::path folder = scratch_folder();
  freeze(freeze_options(folder));
  take_part_in(folder, 4);
  const auto deviations = [&](const std::string& more) {
    return design_in_report(folder, more)["deviations"].dump();
  };
  EXPECT_NE(deviations("").find("4 participants were analysed, not 3"), std::string::npos);
  EXPECT_NE(deviations("--alpha 0.05").find("alpha is 0.05, not 0.01"), std::string::npos);
  const fs::path first = answer_files(folder / "answers").front();
  write_text(folder / "exclude.csv",
             "participant,reason\n" + first.stem().string() + ",spilt tea\n");
  const std::string by_hand = deviations("--exclude exclude.csv");
  EXPECT_NE(by_hand.find("(spilt tea), which no rule of the design says"), std::string::npos);
  EXPECT_EQ(by_hand.find("were analysed, not"), std::string::npos) << by_hand;
  // Answers that were given elsewhere.
  const json good = json::parse(read_whole(first));
  const auto with = [&](const char* pointer, const json& value) {
    json changed = good;
    changed[json::json_pointer(pointer)] = value;
    write_text(first, changed.dump());
    return deviations("");
  };
  const std::string other(64, 'a');
  EXPECT_NE(with("/seed", 8).find("another seed"), std::string::npos);
  EXPECT_NE(with("/started_utc", "2020-01-02T03:04:04Z").find("before the design was frozen"),
            std::string::npos);
  EXPECT_NE(with("/plan/training_trials", 2).find("another plan (training_trials)"),
            std::string::npos);
  write_text(first, good.dump());
  std::map<fs::path, json> originals;
  for (const fs::path& path : answer_files(folder / "answers")) {
    originals[path] = json::parse(read_whole(path));
  }
  // What all were asked and shown, since answers to two questions are not read together.
  for (const auto& [pointer, what] : {std::pair{"/study/question", "another question"},
                                      {"/study/consent_sha256", "another consent text"},
                                      {"/study/clips_sha256", "other clips"}}) {
    for (const auto& [path, file] : originals) {
      json changed = file;
      changed[json::json_pointer(pointer)] = other;
      write_text(path, changed.dump());
    }
    const std::string said = deviations("");
    EXPECT_NE(said.find(std::string(what) + ": 4 of 4 participants"), std::string::npos) << said;
  }
  json clip = good;
  clip["study"]["question"] = other;
  clip["study"]["consent_sha256"] = clip["study"]["clips_sha256"] = other;
  const std::string name = clip["clips_sha256"].begin().key();
  clip["clips_sha256"][name].begin().value() = other;
  fs::create_directories(folder / "one");
  write_text(folder / "one" / "a.json", clip.dump());
  fs::remove_all(folder / "answers");
  fs::rename(folder / "one", folder / "answers");
  EXPECT_NE(deviations("--design out/design.json").find("another clip of `" + name + "`"),
            std::string::npos);
}

TEST(Freeze, NothingElseCanBeServedAfterwards) {
  const fs::path folder = scratch_folder();
  freeze(freeze_options(folder));
  const auto refuses = [&](const auto& change) {
    DeskOptions options = desk_options(folder);
    change(options);
    EXPECT_THROW(Desk{std::move(options)}, std::runtime_error);
  };
  refuses([](DeskOptions& o) { o.seed = 8; });
  refuses([](DeskOptions& o) { o.config.repetitions = 2; });
  refuses([](DeskOptions& o) { o.config.texts["question"] = "Which looks worst?"; });
  refuses([](DeskOptions& o) { o.config.is_pilot = true; });
  DeskOptions pilot = desk_options(folder);
  pilot.config.is_pilot = true;
  EXPECT_NE(message_of<std::runtime_error>([&] {
              Desk{std::move(pilot)};
            }).find("is the folder of a study that is no pilot; leave --pilot out"),
            std::string::npos);
  EXPECT_NO_THROW(Desk{desk_options(folder)});
}

TEST(Freeze, OnlyBeforeTheFirstParticipant) {
  const fs::path folder = scratch_folder();
  const auto why = [](const FreezeOptions& options) -> std::string {
    try {
      freeze(options);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  {
    Desk desk(desk_options(folder));
    EXPECT_NE(why(freeze_options(folder)).find("a server is using"), std::string::npos);
    desk.start("", "browser");
  }
  EXPECT_NE(why(freeze_options(folder)).find("is taking part already"), std::string::npos);
  fs::remove_all(folder / "answers");
  take_part_in(folder, 1);
  EXPECT_NE(why(freeze_options(folder)).find("holds answers already"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "out"));
  // A pilot may go before, in a folder of its own.
  fs::remove_all(folder / "answers");
  {
    DeskOptions pilot = desk_options(folder);
    pilot.config.is_pilot = true;
    Desk desk(std::move(pilot));
    take_part(desk, [](json&) {});
  }
  EXPECT_NE(why(freeze_options(folder)).find("--pilot"), std::string::npos);
  fs::rename(folder / "answers", folder / "pilot");
  FreezeOptions options = freeze_options(folder);
  options.pilot = folder / "pilot";
  EXPECT_EQ(why(options), "");
  EXPECT_NE(
      read_whole(folder / "out" / "preregistration.md").find("A pilot with 1 participant went"),
      std::string::npos);
  EXPECT_NE(why(freeze_options(folder)).find("frozen here already"), std::string::npos);
}

TEST(Freeze, AnotherStudysDesignIsNotOverwritten) {
  const fs::path folder = scratch_folder();
  freeze(freeze_options(folder));
  const std::string design = read_whole(folder / "out" / "design.json");
  const std::string text = read_whole(folder / "out" / "preregistration.md");
  const auto why = [&](const FreezeOptions& options) -> std::string {
    try {
      freeze(options);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  const auto is_left_alone = [&] {
    return read_whole(folder / "out" / "design.json") == design &&
           read_whole(folder / "out" / "preregistration.md") == text;
  };
  FreezeOptions other = freeze_options(folder);
  other.answers = folder / "other";
  EXPECT_EQ(why(other), (folder / "out" / "design.json").string() +
                            ": is of another design, and may be registered; name another --out");
  EXPECT_FALSE(fs::exists(folder / "other"));
  EXPECT_TRUE(is_left_alone());

  // Broken off before the last file: the next run ends it with the text that is there.
  const auto break_off = [&] { fs::remove(design_path(folder / "answers")); };
  break_off();
  FreezeOptions later = freeze_options(folder);
  later.utc = "2021-01-01T00:00:00Z";
  EXPECT_EQ(why(later), "");
  EXPECT_TRUE(is_left_alone());
  EXPECT_EQ(read_whole(design_path(folder / "answers")), design);
  // With other rules it is another design.
  break_off();
  json rules = good_rules;
  rules["exclusions"]["focus_lost_over"] = 6;
  EXPECT_NE(why(freeze_options(folder, rules)).find("is of another design"), std::string::npos);
  // Nor is a text overwritten that somebody has written on.
  write_text(folder / "out" / "preregistration.md", text + "\nMore.\n");
  EXPECT_NE(why(later).find("preregistration.md: is of another design"), std::string::npos);
  EXPECT_FALSE(fs::exists(design_path(folder / "answers")));
}

TEST(Freeze, ARuleAboutChecksNeedsChecks) {
  const fs::path folder = scratch_folder();
  json rules = good_rules;
  rules["exclusions"]["failed_checks_over"] = 1;
  FreezeOptions options = freeze_options(folder, rules);
  EXPECT_THROW(check_rules(options), std::invalid_argument);
  AttentionCheck check;
  check.name = "frozen";
  options.config.attention_checks = {check};
  EXPECT_NO_THROW(check_rules(options));
  EXPECT_NO_THROW(check_rules(freeze_options(folder)));
}

TEST(Freeze, ThePreregistrationTellsTheDesignsFigures) {
  const fs::path folder = scratch_folder();
  FreezeOptions options = freeze_options(folder);
  const std::string line =
      std::string("'") + PINCHLAB_PROGRAM +
      "' stopping --participants 16,32 --share 0.7 --trials 3 --icc 0.1 --alpha 0.01 "
      "--json '" +
      (folder / "rule.json").string() + "' > /dev/null";
  ASSERT_EQ(std::system(line.c_str()), 0);
  const json rule = json::parse(read_whole(folder / "rule.json"));
  options.sample = parse_stopping(rule, "rule.json");
  check_sample(options);
  const std::string hash = freeze(options);
  const std::string text = read_whole(folder / "out" / "preregistration.md");
  for (const std::string& figure :
       {hash, std::string("seed 7"),
        fmt::format("| 16 | {:.4g} |", rule["looks"][0]["p_at_most"].get<double>()),
        std::string("32 participants at most"), std::string("3 demonstrations"),
        std::string("A session has 3 trials"), std::string("left more than 5 times"),
        std::string("alpha = 0.01"), std::string("Intervals are Wilson's of demonstrations that"),
        options.config.texts.at("question"), options.clips.begin()->second.mp4.left->sha256(),
        std::string("Pinch joints look more realistic."), options.utc}) {
    EXPECT_NE(text.find(figure), std::string::npos) << figure << "\n" << text;
  }
  // Of 3 answers a participant, not 4; of the alpha that is tested with.
  for (const auto& [key, value] : {std::pair<const char*, json>{"trials", 4}, {"alpha", 0.05}}) {
    json other = rule;
    other[key] = value;
    options.sample = parse_stopping(other, "rule.json");
    EXPECT_THROW(check_sample(options), std::invalid_argument) << key;
  }
}

TEST(Freeze, ADesignThatWasChangedIsRefused) {
  const fs::path folder = scratch_folder();
  freeze(freeze_options(folder));
  json design = read_json_file(folder / "out" / "design.json", 1U << 20U);
  EXPECT_NO_THROW(parse_design(design, "design.json"));
  design["sample"]["participants"] = {4};
  EXPECT_THROW(parse_design(design, "design.json"), InputError);
  design["sha256"] = design_hash(design);
  EXPECT_NO_THROW(parse_design(design, "design.json"));
  for (const auto& [key, value] : {std::pair<const char*, json>{"seed", -1},
                                   {"frozen_utc", "yesterday"},
                                   {"sample", json::object()},
                                   {"rules", {{"analysis", {{"alpha", 2}}}}},
                                   {"unknown", 1}}) {
    json bad = design;
    bad[key] = value;
    bad["sha256"] = design_hash(bad);
    EXPECT_THROW(parse_design(bad, "design.json"), InputError) << key;
  }
}

TEST(Freeze, RulesAreCheckedWholly) {
  const auto why = [](const json& changes) -> std::string {
    json rules = good_rules;
    rules.update(changes);
    try {
      parse_rules(rules, "rules.json", AnswersKind::two_methods);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(why(json::object()), "");
  EXPECT_NE(why({{"hypotheses", {""}}}), "");
  EXPECT_NE(why({{"exclusions", {{"focus_lost_ovr", 5}}}}).find("focus_lost_over"),
            std::string::npos);
  EXPECT_NE(why({{"exclusions", {{"one_side_over", 0.4}}}}), "");
  EXPECT_NE(why({{"analysis", {{"scale", "thurstone"}}}}), "");  // of three methods and more
  EXPECT_NE(why({{"analysis", {{"bootstrap", 1.5}}}}), "");
  EXPECT_NE(why({{"sample", 3}}), "");
  // As `analyse` would refuse them, after the study.
  const json none = {{"format", "pinchlab-rules 1"},
                     {"analysis", {{"guess", 0.9}, {"lapse", "free"}}}};
  EXPECT_NE(message_of<InputError>([&] {
              parse_rules(none, "r.json", AnswersKind::graded);
            }).find("r.json: /analysis: guesses of 0.9 and lapses of up to 0.1 leave no room"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::study
