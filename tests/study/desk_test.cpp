// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions, answers and what survives a restart.
#include "study/desk.h"
#include "base/answer_file.h"
#include "base/read_file.h"
#include "base/sha256.h"

#include <sys/stat.h>

#include <memory>
#include <regex>
#include <sstream>
#include <thread>

#include "analysis/answers_table.h"
#include "base/input_error.h"
#include "study/answers.h"
#include "study/study_file.h"
#include "study/tables.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void answer_all(Desk& desk, const std::string& token) {
  const Progress progress = desk.progress(token);
  for (std::size_t i = progress.next; i < progress.trials.size(); ++i) {
    desk.show(token, i);
    desk.answer(token, parse_answer(answer_body(i, i % 2 == 0 ? "left" : "right")));
  }
}

TEST(Session, AnswersComeOneByOneAndCountOnce) {
  Desk desk(desk_options(scratch_folder()));
  const std::string token = desk.start("", "browser");
  EXPECT_EQ(refused([&] { desk.answer(token, parse_answer(answer_body(0))); }), 409) << "not shown";
  EXPECT_EQ(refused([&] { desk.show(token, 1); }), 409) << "not the next";
  desk.show(token, 0);
  desk.show(token, 0);  // a reload
  EXPECT_EQ(refused([&] { desk.answer(token, parse_answer(answer_body(1))); }), 409);
  desk.answer(token, parse_answer(answer_body(0)));
  desk.answer(token, parse_answer(answer_body(0)));  // sent again
  EXPECT_EQ(desk.progress(token).next, 1U);
  EXPECT_EQ(refused([&] { desk.answer(token, parse_answer(answer_body(0, "right"))); }), 409)
      << "nobody changes an answer";
  EXPECT_EQ(refused([&] { desk.save(token, {}); }), 409) << "trials are left";
  answer_all(desk, token);
  EXPECT_EQ(refused([&] { desk.show(token, 3); }), 409) << "there is no such trial";
}

TEST(Session, BodiesAreCheckedWholly) {
  const auto status = [](const char* key, const json& value) {
    json body = answer_body(0);
    body[key] = value;
    return refused([&] { parse_answer(body); });
  };
  EXPECT_EQ(refused([] { parse_answer(answer_body(0)); }), 0);
  const json good = answer_body(0);
  for (const auto& item : good.items()) {
    json body = good;
    body.erase(item.key());
    const bool is_optional = item.key().starts_with("loop_gap_");
    EXPECT_EQ(refused([&] { parse_answer(body); }), is_optional ? 0 : 422)
        << item.key() << " missing";
    EXPECT_EQ(status(item.key().c_str(), json::object()), 422) << item.key();
    EXPECT_EQ(status(item.key().c_str(), -2), 422) << item.key();
  }
  EXPECT_EQ(status("choice", "both"), 422);
  EXPECT_EQ(status("reaction_time_s", 1e9), 422);
  EXPECT_EQ(status("unknown", 1), 422);
  EXPECT_EQ(status("dropped_frames", 900), 0);
  EXPECT_EQ(status("dropped_frames", 901), 422) << "of 900 frames";
  EXPECT_EQ(status("playback_errors", json::array({std::string(501, 'x')})), 422);
  EXPECT_EQ(refused([] {
              parse_free_text({{"free_text", {{"thoughts", std::string(20001, 'x')}}}});
            }),
            422);
  EXPECT_EQ(refused([] { parse_free_text({{"free_text", {{"other", "x"}}}}); }), 422);
}

TEST(Session, FileGivesTheSameBack) {
  Session session;
  session.id = "0123456789abcdef";
  session.secret_sha256 = sha256("x");
  session.seed = largest_seed;
  session.started_utc = session.last_seen_utc = "2026-11-20T12:05:01.250Z";
  session.plan = make_plan(1, 2, plan_options(small_config()));
  session.media = {"a", "b", "c"};
  show(session, 0, session.started_utc);
  answer(session, 0, parse_answer(answer_body(0)).answer);
  EXPECT_EQ(to_json(session_from_json(to_json(session))), to_json(session));
}

TEST(Desk, AnswersFeedTheStatistics) {
  const fs::path folder = scratch_folder();
  Desk desk(desk_options(folder));
  for (int i = 0; i < 4; ++i) {
    const std::string token = desk.start("", "browser\xFF\n");
    answer_all(desk, token);
    desk.save(token, {{"thoughts", "\"åäö\", with a comma"}});
  }
  const auto table = analysis::read_answers({folder / "answers"}, {});
  EXPECT_EQ(table.participants.size(), 4U);
  // In every block of two both sides are seen, and left is always chosen at the same positions.
  const json file = json::parse(read_whole(answer_files(folder / "answers").front()));
  EXPECT_EQ(file["trials"].size(), 3U);
  EXPECT_EQ(file["user_agent"], "browser??");
  write_text(folder / "answers.csv", answers_csv(folder / "answers"));
  analysis::ReadOptions options;
  options.ignore_other_columns = true;
  EXPECT_EQ(analysis::read_answers({folder / "answers.csv"}, options).participants.size(), 4U);
}

TEST(Desk, AttentionChecksAndTrainingAreKeptApart) {
  const fs::path folder = scratch_folder();
  DeskOptions options = desk_options(folder);
  for (const char* side : {"left", "right"}) {
    write_text(folder / "clips" / (std::string("check-") + side + ".mp4"),
               std::string("clip ") + side);
  }
  options.config.training = {"03-third"};
  options.config.attention_checks = {{"upside-down", "", "check-left.mp4", "check-right.mp4"}};
  options.clips = open_clips(folder / "clips", options.config);
  Desk desk(std::move(options));
  const std::string token = desk.start("", "");
  EXPECT_EQ(desk.progress(token).trials.size(), 5U);
  EXPECT_TRUE(desk.progress(token).trials.front().is_practice);
  answer_all(desk, token);
  desk.save(token, {});
  const json file = json::parse(read_whole(answer_files(folder / "answers").front()));
  int checks = 0;
  for (const json& trial : file["trials"]) {
    if (trial["kind"] == "attention") {
      ++checks;
      const std::string expected = trial["expected"];
      EXPECT_EQ(trial["clip"], "check-" + expected + ".mp4");
      EXPECT_EQ(trial["left"], "check");
      EXPECT_EQ(file["clips_sha256"]["upside-down"]["check_" + expected],
                sha256("clip " + expected));
    }
  }
  EXPECT_EQ(checks, 1);
  EXPECT_EQ(analysis::read_answers({folder / "answers"}, {}).participants.size(), 1U);
}

TEST(Desk, RestartLosesNobody) {
  const fs::path folder = scratch_folder();
  std::string token, saved, code;
  {
    Desk desk(desk_options(folder));
    token = desk.start("", "");
    desk.show(token, 0);
    desk.answer(token, parse_answer(answer_body(0)));
    saved = desk.start("", "");
    answer_all(desk, saved);
    code = desk.save(saved, {});
  }
  Desk desk(desk_options(folder));
  EXPECT_EQ(desk.progress(token).next, 1U);
  EXPECT_EQ(desk.save(saved, {}), code) << "saved once, same code";
  EXPECT_EQ(answer_files(folder / "answers").size(), 1U);
  answer_all(desk, token);
  desk.save(token, {});
  EXPECT_EQ(answer_files(folder / "answers").size(), 2U);
  EXPECT_TRUE(desk.overview().running.empty());
}

std::vector<std::string> partial_files(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".partial") {
      names.push_back(entry.path().filename().string());
    }
  }
  return names;
}

TEST(Desk, WhatAKilledServerLeftHalfWrittenIsNotKept) {
  const fs::path folder = scratch_folder();
  std::string token;
  const auto leave_partials = [&] {
    const std::string name = token.substr(0, 16) + ".json.partial";
    write_text(folder / "answers" / name, R"({"free_text":{"thoughts":"what I wrote)");
    write_text(folder / "answers" / ".running" / name, "{");
  };
  {
    Desk desk(desk_options(folder));
    token = desk.start("", "");
    leave_partials();
  }
  write_text(folder / "answers" / "notes.partial", "the researcher's own");
  Desk desk(desk_options(folder));
  EXPECT_EQ(partial_files(folder), std::vector<std::string>{"notes.partial"}) << "at start";
  leave_partials();
  desk.leave(token);
  EXPECT_EQ(partial_files(folder), std::vector<std::string>{"notes.partial"}) << "on leaving";
}

TEST(Desk, ArchivesOfAKilledDownloadAreNotKept) {
  const fs::path folder = scratch_folder();
  { const Desk desk(desk_options(folder)); }
  const fs::path running = folder / "answers" / ".running";
  for (const char* name : {"0123456789abcdef.zip", "0123456789abcdef.zip.partial"}) {
    write_text(running / name, "what all have answered");
  }
  write_text(folder / "answers" / "backup.zip", "the researcher's own");
  const Desk desk(desk_options(folder));
  EXPECT_EQ(std::distance(fs::directory_iterator(running), {}), 1) << "the study's file";
  EXPECT_TRUE(fs::exists(folder / "answers" / "backup.zip"));
}

// Whoever is told "left" has left, and whoever has saved is told so.
TEST(Desk, SavingAndLeavingAtOnceTellsTheTruth) {
  const fs::path folder = scratch_folder();
  Desk desk(desk_options(folder));
  int both = 0;
  for (int i = 0; i < 60; ++i) {
    const std::string token = desk.start("", "");
    answer_all(desk, token);
    int save = 0, leave = 0;
    {
      std::jthread saver([&] { save = refused([&] { desk.save(token, {}); }); });
      std::jthread leaver([&] { leave = refused([&] { desk.leave(token); }); });
    }
    const bool is_kept = fs::exists(answer_path(folder / "answers", token.substr(0, 16)));
    EXPECT_EQ(save, is_kept ? 0 : 401);
    EXPECT_EQ(leave, is_kept ? 409 : 0);
    both += save == 0 && leave == 0 ? 1 : 0;
  }
  EXPECT_EQ(both, 0);
  const std::string token = desk.start("", "");
  answer_all(desk, token);
  desk.save(token, {});
  EXPECT_EQ(refused([&] { desk.leave(token); }), 409) << "in another window, later";
}

TEST(Desk, TokensOfOthersOpenNothing) {
  Desk desk(desk_options(scratch_folder()));
  const std::string a = desk.start("", ""), b = desk.start("", "");
  const std::string mixed = a.substr(0, 17) + b.substr(17);
  for (const std::string& token : {mixed, std::string(), std::string("."), a + "0", a.substr(0, 48),
                                   std::string("../../etc.") + b.substr(17)}) {
    EXPECT_EQ(refused([&] { desk.progress(token); }), 401) << token;
    EXPECT_EQ(refused([&] { desk.save(token, {}); }), 401) << token;
  }
}

TEST(Desk, AnotherStudyInTheFolderIsRefused) {
  const fs::path folder = scratch_folder();
  { Desk desk(desk_options(folder)); }
  DeskOptions seed = desk_options(folder);
  seed.seed = 8;
  EXPECT_THROW(Desk{std::move(seed)}, std::runtime_error);
  DeskOptions plan = desk_options(folder);
  plan.config.both_orders = true;
  EXPECT_THROW(Desk{std::move(plan)}, std::runtime_error);
  DeskOptions same = desk_options(folder);
  same.seed.reset();
  Desk desk(std::move(same));
  EXPECT_EQ(desk.seed(), 7U);
  EXPECT_THROW(Desk{desk_options(folder)}, std::runtime_error) << "two servers at a time";
}

// Answers to another question, or to other clips, do not come into the same folder.
TEST(Desk, WhatIsAskedAndShownStaysTheSame) {
  const fs::path folder = scratch_folder();
  {
    Desk desk(desk_options(folder));
    const std::string token = desk.start("", "");
    answer_all(desk, token);
    desk.save(token, {});
  }
  const auto told = [&](const char* key, const char* text) {
    DeskOptions options = desk_options(folder);
    if (std::string(key) == "language") {
      options.config.language = text;
    } else {
      options.config.texts[key] = text;
    }
    try {
      Desk desk(std::move(options));
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(told("question", "Which looks worst?").find("the question"), std::string::npos);
  EXPECT_NE(told("consent", "Yes.").find("the consent text"), std::string::npos);
  EXPECT_NE(told("left_label", "This").find("a text of the page"), std::string::npos);
  EXPECT_NE(told("language", "sv").find("the language"), std::string::npos);
  EXPECT_EQ(told("language", "en"), "");
  // Also where only the answers are left of the study.
  fs::remove_all(folder / "answers" / ".running");
  EXPECT_NE(told("question", "Which looks worst?").find("another --answers"), std::string::npos);
  fs::remove_all(folder / "answers" / ".running");
  fs::remove_all(folder / "clips");
  write_clips(folder / "clips", demonstrations, 100001);
  EXPECT_NE(told("language", "en").find("another --answers"), std::string::npos);
  // And where two folders are analysed or exported together.
  const fs::path file = answer_files(folder / "answers").front();
  json other = json::parse(read_whole(file));
  EXPECT_EQ(other["study"]["question"], small_config().texts["question"]);
  other["participant"] = "somebody-else";
  other["study"]["question"] = "Which looks worst?";
  write_text(folder / "answers" / "somebody-else.json", other.dump());
  EXPECT_THROW(analysis::read_answers({folder / "answers"}, {}), InputError);
  EXPECT_THROW(answers_csv(folder / "answers"), InputError);
}

TEST(Desk, UnwritableFolderIsToldAndNothingIsLost) {
  const fs::path folder = scratch_folder();
  Desk desk(desk_options(folder));
  const std::string token = desk.start("", "");
  answer_all(desk, token);
  fs::rename(folder / "answers", folder / "away");
  EXPECT_EQ(refused([&] { desk.save(token, {}); }), 507);
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 503);
  fs::rename(folder / "away", folder / "answers");
  EXPECT_TRUE(answer_files(folder / "answers").empty());
  desk.save(token, {});
  EXPECT_EQ(answer_files(folder / "answers").size(), 1U);
}

TEST(Withdraw, RemovesOneParticipant) {
  const fs::path folder = scratch_folder();
  std::vector<std::string> codes;
  Desk desk(desk_options(folder));
  for (int i = 0; i < 3; ++i) {
    const std::string token = desk.start("", "");
    answer_all(desk, token);
    codes.push_back(desk.save(token, {}));
  }
  std::string typed = codes[1];
  std::ranges::replace(typed, '-', ' ');
  std::ranges::transform(typed, typed.begin(), [](unsigned char c) { return std::tolower(c); });
  EXPECT_TRUE(withdraw(folder / "answers", typed));
  EXPECT_FALSE(withdraw(folder / "answers", codes[1])) << "gone already";
  EXPECT_EQ(answer_files(folder / "answers").size(), 2U);
  EXPECT_THROW(withdraw(folder / "answers", "nonsense"), std::invalid_argument);
}

// Before clips are rendered for it.
TEST(Desk, AFolderInUseIsToldBeforeAnythingIsDone) {
  const fs::path folder = scratch_folder();
  check_answers_folder(folder / "answers");
  auto desk = std::make_unique<Desk>(desk_options(folder));
  EXPECT_THROW(check_answers_folder(folder / "answers"), FolderTaken);
  desk.reset();
  check_answers_folder(folder / "answers");
}

// At once, not only after a restart, so that the plan stays counterbalanced.
TEST(Withdraw, GivesThePlaceToTheNextWhoComes) {
  const fs::path folder = scratch_folder();
  DeskOptions options = desk_options(folder);
  options.config.participant_limit = 2;
  Desk desk(std::move(options));
  std::vector<std::string> codes;
  for (int i = 0; i < 2; ++i) {
    const std::string token = desk.start("", "");
    answer_all(desk, token);
    codes.push_back(desk.save(token, {}));
  }
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 409);
  desk.withdraw(codes[0]);
  EXPECT_EQ(desk.overview().finished, 1U);
  const std::string token = desk.start("", "");
  EXPECT_EQ(desk.overview().running.at(0).number, 0U);
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 409);
  answer_all(desk, token);
  desk.save(token, {});
  EXPECT_EQ(answer_files(folder / "answers").size(), 2U);
}

TEST(Export, PsychDs) {
  const fs::path folder = scratch_folder();
  Desk desk(desk_options(folder));
  const std::string token = desk.start("", "");
  answer_all(desk, token);
  desk.save(token, {});
  write_psych_ds(folder / "answers", folder / "dataset");
  const json description = json::parse(read_whole(folder / "dataset" / "dataset_description.json"));
  const std::string csv = read_whole(folder / "dataset" / "data" / "study-cables_data.csv");
  std::string header;
  for (const json& variable : description["variableMeasured"]) {
    header += (header.empty() ? "" : ",") + variable["name"].get<std::string>();
  }
  EXPECT_EQ(csv.substr(0, csv.find('\n')), header);
  // Psych-DS 1.5.1: rules/dataset_metadata.yaml and rules/files/tabular_data/data.yaml
  for (const char* key : {"@context", "@type", "name", "description", "variableMeasured"}) {
    EXPECT_TRUE(description.contains(key)) << key;
  }
  EXPECT_EQ(description["@context"], "https://schema.org/");
  EXPECT_EQ(description["@type"], "Dataset");
  const std::regex data_file(R"(([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv)");
  int data_files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "dataset" / "data")) {
    EXPECT_TRUE(std::regex_match(entry.path().filename().string(), data_file)) << entry.path();
    ++data_files;
  }
  EXPECT_EQ(data_files, 1);
  std::istringstream rows(csv);
  for (std::string row; std::getline(rows, row);) {
    EXPECT_EQ(std::ranges::count(row, ','), std::ranges::count(header, ',')) << row;
  }
  EXPECT_TRUE(fs::exists(folder / "dataset" / "README.md"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 4);
  EXPECT_THROW(write_psych_ds(folder / "answers", folder / "dataset"), std::runtime_error);
}

TEST(Desk, EachParticipantHasTheirLanguage) {
  const fs::path folder = scratch_folder();
  const auto options = [&] {
    DeskOptions made = desk_options(folder);
    made.config = parse_config({{"format", "pinchlab-study 1"},
                                {"demonstrations", demonstrations},
                                {"languages", {"en", "sv"}}},
                               "study.json");
    return made;
  };
  std::string token;
  {
    Desk desk(options());
    EXPECT_EQ(refused([&] { desk.start("", "", "", {}, "de"); }), 422);
    EXPECT_EQ(desk.progress(desk.start("", "")).language, "en");
    token = desk.start("", "", "", {}, "sv");
  }
  Desk desk(options());
  EXPECT_EQ(desk.progress(token).language, "sv") << "also after a restart";
  answer_all(desk, token);
  desk.save(token, {});
  const json file = json::parse(read_whole(answer_files(folder / "answers").front()));
  EXPECT_EQ(file["language"], "sv");
  EXPECT_EQ(file["study"]["language"], "en, sv") << "one study";
}

TEST(Export, FormulasAreHarmless) {
  const fs::path folder = scratch_folder();
  Desk desk(desk_options(folder));
  const std::string token = desk.start("", "");
  answer_all(desk, token);
  desk.save(token, {});
  const fs::path path = answer_files(folder / "answers").front();
  json file = json::parse(read_whole(path));
  file["trials"][0]["clip"] = "=HYPERLINK(\"http://evil.example\")";
  file["trials"][1]["clip"] = "@SUM(A1)";
  file["trials"][2]["clip"] = "-1+cmd|' /C calc'!A0";
  file["trials"][0]["reason"] = "+1+1";
  file["trials"][1]["reason"] = "-1-E1";
  file["trials"][2]["loop_gap_median_s"] = -0.001;
  write_text(path, file.dump());
  const std::string csv = answers_csv(folder / "answers");
  EXPECT_NE(csv.find(",\"'=HYPERLINK(\"\"http://evil.example\"\")\","), std::string::npos) << csv;
  EXPECT_NE(csv.find(",'@SUM(A1),"), std::string::npos);
  EXPECT_NE(csv.find(",'-1+cmd|"), std::string::npos);
  EXPECT_NE(csv.find(",'+1+1\n"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",'-1-E1\n"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",-0.001,"), std::string::npos) << "a number is none";
}

TEST(Clips, AllAreServedInOneSize) {
  const fs::path folder = scratch_folder();
  write_clips(folder);
  const Clips clips = open_clips(folder, small_config());
  for (const auto& [name, files] : clips) {
    EXPECT_NE(files.mp4.left->file_size(), files.mp4.right->file_size());
    EXPECT_EQ(files.mp4.left->served_size(), files.mp4.right->served_size());
    EXPECT_EQ(files.mp4.left->served_size(), clips.begin()->second.mp4.left->served_size());
    const Clip& clip = *files.mp4.left;
    const std::string whole = clip.read(0, clip.served_size() + 10);
    ASSERT_EQ(whole.size(), clip.served_size());
    EXPECT_EQ(whole.substr(0, clip.file_size()), read_whole(folder / clip.name()));
    EXPECT_EQ(whole.substr(clip.file_size() + 4, 4), "free");
    for (const std::uint64_t offset :
         {std::uint64_t{0}, clip.file_size() - 3, clip.file_size() + 5, clip.served_size() - 1}) {
      EXPECT_EQ(clip.read(offset, 20), whole.substr(offset, 20));
    }
  }
}

TEST(Clips, AChangedFileIsRefused) {
  const fs::path folder = scratch_folder();
  write_clips(folder);
  write_text(folder / "02-second.left-pinch.mp4", "other");
  EXPECT_THROW(open_clips(folder, small_config()), std::runtime_error);
  Config config = small_config();
  config.demonstrations = {"02-secnd"};
  EXPECT_THROW(open_clips(folder, config), std::runtime_error);
}

}  // namespace
}  // namespace pinchlab::study
