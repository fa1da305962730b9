// SPDX-License-Identifier: GPL-3.0-or-later
// What the researcher's page asks the server for.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <thread>

#include "base/answer_file.h"
#include "base/read_file.h"
#include "study/http_client.h"
#include "study/results.h"
#include "study/server.h"
#include "tests/base/message_of.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using pinchlab::test::message_of;

// Takes part on a small screen, always choosing `side`; returns the withdrawal code.
std::string take_part(Desk& desk, const char* side) {
  return study::take_part(desk, [&](json& body) {
    body["choice"] = side;
    body["clip_width_px"] = 800;
  });
}

TEST(Researcher, ResultsAreBlindUnlessAskedFor) {
  RunningServer running(desk_options(scratch_folder()));
  take_part(running.desk, "left");
  take_part(running.desk, "left");
  HttpClient client(running.server.address());
  const std::string token = running.server.researcher_token();
  const auto blind = client.post("/api/results", {{"reveal", false}}, token);
  ASSERT_EQ(blind->status, 200);
  EXPECT_EQ(blind->body.find("pinch"), std::string::npos);
  const json results = json::parse(blind->body);
  EXPECT_EQ(results["finished"], 2);
  EXPECT_EQ(results["sides"], (json{{"left", 6}, {"right", 0}}));
  EXPECT_EQ(results["demonstrations"].size(), 3U);
  EXPECT_EQ(results["demonstrations"][0],
            (json{{"name", "01-first"}, {"answers", 2}, {"left", 2}}));
  EXPECT_EQ(results["warnings"][0]["code"], "small_clip");
  EXPECT_EQ(results["pilot"], false);
  const json shown = json::parse(client.post("/api/results", {{"reveal", true}}, token)->body);
  // Two participants see opposite sides.
  EXPECT_EQ(shown["demonstrations"][0]["chosen"], (json{{"pinch", 1}, {"baseline", 1}}));
}

TEST(Researcher, NothingIsHadWithoutTheToken) {
  RunningServer running(desk_options(scratch_folder()));
  const std::string code = take_part(running.desk, "left");
  HttpClient client(running.server.address());
  const std::string wrong(32, '0');
  EXPECT_EQ(client.post("/api/results", {{"reveal", true}}, wrong)->status, 401);
  EXPECT_EQ(client.post("/api/preview", {{"number", 0}}, wrong)->status, 401);
  EXPECT_EQ(client.post("/api/withdraw", {{"code", code}}, wrong)->status, 401);
  for (const char* what : {"answers.zip", "answers.csv", "psych-ds.zip"}) {
    EXPECT_EQ(client.get(std::string("/api/download/") + what)->status, 401) << what;
    EXPECT_EQ(client.get(std::string("/api/download/") + what, bearer(wrong))->status, 401);
  }
  EXPECT_EQ(client.post("/api/results", {{"reveal", 1}}, running.server.researcher_token())->status,
            422);
  EXPECT_EQ(
      client.post("/api/preview", {{"number", -1}}, running.server.researcher_token())->status,
      422);
}

TEST(Researcher, APreviewShowsWhatAParticipantIsShown) {
  RunningServer running(desk_options(scratch_folder()));
  HttpClient client(running.server.address());
  const std::string token = running.server.researcher_token();
  const json preview = json::parse(client.post("/api/preview", {{"number", 0}}, token)->body);
  const std::string started = running.desk.start("", "browser");  // number 0
  const Progress progress = running.desk.progress(started);
  ASSERT_EQ(preview["trials"].size(), progress.trials.size());
  for (std::size_t i = 0; i < progress.trials.size(); ++i) {
    const auto clip = client.get(preview["trials"][i]["mp4"]);
    ASSERT_EQ(clip->status, 200);
    EXPECT_EQ(clip->body, client.get("/media/" + progress.trials[i].media + ".mp4")->body);
  }
  client.post("/api/preview", {{"number", 1}}, token);
  EXPECT_EQ(client.get(preview["trials"][0]["mp4"])->status, 404) << "only the last preview";
}

TEST(Researcher, WithdrawsByCodeAndDownloads) {
  const fs::path folder = scratch_folder();
  RunningServer running(desk_options(folder));
  const std::string code = take_part(running.desk, "left");
  take_part(running.desk, "right");
  HttpClient client(running.server.address());
  const std::string token = running.server.researcher_token();
  const auto zip = client.get("/api/download/answers.zip", bearer(token));
  ASSERT_EQ(zip->status, 200);
  EXPECT_EQ(zip->header("content-type"), "application/zip");
  write_text(folder / "answers.zip", zip->body);
  fs::create_directories(folder / "out");
  const std::string unzip = "cd '" + folder.string() + "' && python3 -m zipfile -e answers.zip out";
  if (std::system("python3 -c '' 2> /dev/null") == 0) {
    ASSERT_EQ(std::system(unzip.c_str()), 0);
    const auto files = answer_files(folder / "out" / "answers");
    ASSERT_EQ(files.size(), 2U);
    for (const fs::path& file : files) {
      EXPECT_EQ(read_whole(file), read_whole(folder / "answers" / file.filename()));
    }
  }
  const auto csv = client.get("/api/download/answers.csv", bearer(token));
  EXPECT_EQ(std::ranges::count(csv->body, '\n'), 7);
  EXPECT_EQ(client.get("/api/download/psych-ds.zip", bearer(token))->status, 200);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "answers/.running"), {}), 1)
      << "the study's file: no archive is left behind";

  EXPECT_EQ(client.post("/api/withdraw", {{"code", "nonsense"}}, token)->status, 422);
  EXPECT_EQ(client.post("/api/withdraw", {{"code", "0000-0000-0000"}}, token)->status, 404);
  EXPECT_EQ(client.post("/api/withdraw", {{"code", code}}, token)->status, 200);
  EXPECT_EQ(answer_files(folder / "answers").size(), 1U);
  const json results = json::parse(client.post("/api/results", {{"reveal", false}}, token)->body);
  EXPECT_EQ(results["finished"], 1);
  EXPECT_EQ(running.desk.overview().finished, 1U);
}

// The page says that there is a problem, the terminal which.
TEST(Researcher, FaultsAreToldOnTheTerminal) {
  const fs::path folder = scratch_folder();
  RunningServer running(desk_options(folder));
  take_part(running.desk, "left");
  write_text(answer_files(folder / "answers").front(), "{");
  HttpClient client(running.server.address());
  testing::internal::CaptureStderr();
  const auto reply =
      client.get("/api/download/answers.csv", bearer(running.server.researcher_token()));
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_EQ(reply->status, 500);
  EXPECT_EQ(reply->body.find("JSON"), std::string::npos) << reply->body;
  EXPECT_NE(told.find(" GET /api/download/answers.csv: "), std::string::npos) << told;
  EXPECT_NE(told.find("not JSON"), std::string::npos) << told;
}

TEST(Researcher, APilotIsMarkedAndKeptApart) {
  const fs::path folder = scratch_folder();
  const auto options = [&](bool is_pilot) {
    DeskOptions desk = desk_options(folder);
    desk.config.is_pilot = is_pilot;
    return desk;
  };
  {
    Desk desk(options(true));
    take_part(desk, "left");
  }
  EXPECT_EQ(json::parse(read_whole(answer_files(folder / "answers").front()))["pilot"], true);
  EXPECT_NE(message_of<std::runtime_error>([&] {
              Desk(options(false));
            }).find("is the folder of a pilot; go on with that by `study serve --pilot`"),
            std::string::npos);
  EXPECT_NO_THROW(Desk(options(true)));
  fs::remove_all(folder / "answers" / ".running");
  EXPECT_THROW(Desk(options(false)), std::runtime_error) << "its answers alone";
}

// Of a participant p, without trials yet.
json levels_answered() {
  return {
      {"format", "pinchlab-answers"},
      {"version", 1},
      {"participant", "p"},
      {"plan",
       {{"demonstrations", {"d"}}, {"graded_hit", "graded"}, {"answers_per_demonstration", 10}}},
      {"started_utc", "2026-11-20T12:00:00.000Z"},
      {"saved_utc", "2026-11-20T12:10:00.000Z"},
      {"software_version", "1"},
      {"trials", json::array()}};
}

TEST(Results, CountWhatCallsForALook) {
  const fs::path folder = scratch_folder();
  json file = levels_answered();
  for (int i = 0; i < 10; ++i) {
    file["trials"].push_back({{"position", i + 1},
                              {"kind", "main"},
                              {"demonstration", "d"},
                              {"left", "graded"},
                              {"right", "reference"},
                              {"level", 0.5},
                              {"choice", "right"},
                              {"reaction_time_s", 1},
                              {"frame_count", 100},
                              {"dropped_frames", i == 0 ? 30 : 0},
                              {"clip_width_px", 1200},
                              {"focus_lost_count", 1}});
  }
  file["trials"].push_back({{"position", 11},
                            {"kind", "attention"},
                            {"demonstration", "c"},
                            {"choice", "left"},
                            {"reaction_time_s", 1},
                            {"expected", "right"},
                            {"left", "check"},
                            {"right", "check"}});
  write_text(folder / "p.json", file.dump());
  file["software_version"] = "2";
  file["participant"] = "q";
  file["trials"].erase(10);
  write_text(folder / "q.json", file.dump());
  Results results(folder);
  std::map<std::string, int> codes;
  const json read = results.read(true);
  for (const json& warning : read["warnings"]) ++codes[warning["code"]];
  EXPECT_EQ(codes, (std::map<std::string, int>{{"dropped_frames", 2},
                                               {"failed_check", 1},
                                               {"focus_lost", 2},
                                               {"one_side", 2},
                                               {"versions", 1}}));
  EXPECT_EQ(read["demonstrations"][0]["levels"]["0.5"]["reference"], 20);
  EXPECT_FALSE(results.read(false)["demonstrations"][0].contains("levels"));
  fs::remove(folder / "q.json");
  EXPECT_EQ(results.read(false)["finished"], 1);
}

// A file that is no answer file costs nothing but a warning, while it is there.
TEST(Results, WhatIsNoAnswerFileIsAWarning) {
  const fs::path folder = scratch_folder();
  RunningServer running(desk_options(folder));
  take_part(running.desk, "left");
  const auto results = [&] {
    const auto reply =
        HttpClient(running.server.address())
            .post("/api/results", {{"reveal", true}}, running.server.researcher_token());
    EXPECT_EQ(reply->status, 200) << reply->body;
    return json::parse(reply->body);
  };
  const json before = results();
  for (const char* text : {"{", "{}", "[]", R"({"trials": [{}]})", R"({"trials": 1})"}) {
    write_text(folder / "answers/notes.json", text);
    const json with = results();
    EXPECT_EQ(with["finished"], 1);
    EXPECT_EQ(with["demonstrations"], before["demonstrations"]);
    const json& first = with["warnings"].front();
    EXPECT_EQ(first["code"], "no_answer_file");
    EXPECT_EQ(first["participant"], "notes.json");
    EXPECT_NE(first["value"], "");
  }
  fs::remove(folder / "answers/notes.json");
  EXPECT_EQ(results(), before);
}

// Answers can be withdrawn while they are counted.
TEST(Results, FilesMayGoMeanwhile) {
  const fs::path folder = scratch_folder();
  {
    Desk desk(desk_options(folder));
    take_part(desk, "left");
  }
  const fs::path answers = folder / "answers", file = answer_files(answers).front();
  const std::string text = read_whole(file);
  std::atomic<bool> is_done = false;
  std::thread other([&] {
    for (int i = 0; !is_done; ++i) {
      const fs::path path = answers / fmt::format("{}.json", i);
      write_text(folder / "next", text);
      fs::rename(folder / "next", path);
      fs::remove(path);
    }
  });
  Results results(answers);
  std::string error;
  for (int i = 0; i < 1000 && error.empty(); ++i) {
    try {
      const json read = results.read(true);
      if (read["warnings"].dump().find("no_answer_file") != std::string::npos) error = read.dump();
    } catch (const std::exception& thrown) {
      error = thrown.what();
    }
  }
  is_done = true;
  other.join();
  EXPECT_EQ(error, "");
  EXPECT_EQ(results.read(true)["finished"], 1);
}

}  // namespace
}  // namespace pinchlab::study
