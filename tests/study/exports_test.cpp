// SPDX-License-Identifier: GPL-3.0-or-later
// Answers as tables of participants and as a BIDS dataset.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "study/answers.h"
#include "study/crate.h"
#include "study/tables.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path answered(int participants) {
  const fs::path folder = scratch_folder();
  Desk desk(desk_options(folder));
  for (int i = 0; i < participants; ++i) {
    take_part(desk, [&](json& body) {
      body["clip_width_px"] = 1000 + i;
      body["frame_count"] = 200;
      body["dropped_frames"] = 10;
    });
  }
  return folder;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, separator);) cells.push_back(cell);
  return cells;
}

TEST(Exports, OneRowAParticipant) {
  const fs::path folder = answered(2);
  const auto lines = lines_of(participants_csv(folder / "answers"));
  ASSERT_EQ(lines.size(), 3U);
  const auto names = cells_of(lines[0], ',');
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto cells = cells_of(lines[i], ',');
    const auto cell = [&](const char* name) {
      return cells.at(static_cast<std::size_t>(std::ranges::find(names, name) - names.begin()));
    };
    EXPECT_EQ(cell("answers"), "3");
    EXPECT_EQ(cell("dropped_frames_share"), "0.05");
    EXPECT_EQ(cell("one_side_share"), "1");
    EXPECT_EQ(cell("smallest_clip_width_px"), "100" + cell("participant_number"));
    EXPECT_TRUE(fs::exists(answer_path(folder / "answers", cell("participant"))));
  }
}

TEST(Exports, ABidsDatasetHoldsEveryTrial) {
  const fs::path folder = answered(2);
  const fs::path path = answer_files(folder / "answers").front();
  json file = json::parse(read_whole(path));
  file["free_text"]["thoughts"] = "a\ttab\nand a line";
  write_text(path, file.dump());
  write_bids(folder / "answers", folder / "bids");
  const json dataset = json::parse(read_whole(folder / "bids/dataset_description.json"));
  EXPECT_EQ(dataset["BIDSVersion"], "1.9.0");
  const auto participants = lines_of(read_whole(folder / "bids/participants.tsv"));
  ASSERT_EQ(participants.size(), 3U);
  const auto names = cells_of(participants[0], '\t');
  EXPECT_EQ(names.front(), "participant_id");
  const json about = json::parse(read_whole(folder / "bids/participants.json"));
  for (const std::string& name : names) EXPECT_TRUE(about.contains(name)) << name;
  bool has_text = false;
  for (std::size_t i = 1; i < participants.size(); ++i) {
    const auto cells = cells_of(participants[i], '\t');
    ASSERT_EQ(cells.size(), names.size()) << participants[i];
    has_text = has_text || cells.back() == "a tab and a line";
    const std::string& id = cells.front();
    const auto trials =
        lines_of(read_whole(folder / "bids" / id / "beh" / (id + "_task-cables_beh.tsv")));
    ASSERT_EQ(trials.size(), 4U);
    const auto columns = cells_of(trials[0], '\t');
    const json trial_about = json::parse(read_whole(folder / "bids/task-cables_beh.json"));
    for (const std::string& name : columns) EXPECT_TRUE(trial_about.contains(name)) << name;
    for (const std::string& trial : trials) {
      EXPECT_EQ(cells_of(trial, '\t').size(), columns.size());
    }
  }
  EXPECT_TRUE(has_text);
  EXPECT_THROW(write_bids(folder / "answers", folder / "bids"), std::runtime_error);
}

TEST(Exports, ACrateHoldsWhatWasShown) {
  const fs::path folder = answered(4);
  write_text(folder / "clips/manifest.json", "{}");
  write_ro_crate(folder / "answers", folder / "clips", folder / "crate");
  // The program's own check of crates: every MUST of the two documents, and every file's hash.
  const std::string check = std::string("'") + PINCHLAB_PROGRAM + "' crate '" +
                            (folder / "crate").string() + "' > '" + (folder / "out.txt").string() +
                            "' 2>&1";
  EXPECT_EQ(std::system(check.c_str()), 0) << read_whole(folder / "out.txt");
  EXPECT_EQ(read_whole(folder / "crate/data/answers.csv"), answers_csv(folder / "answers"));
  const auto clip = [](const fs::path& path) { return path.extension() == ".mp4"; };
  int clips = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "crate/stimuli")) {
    clips += clip(entry.path()) ? 1 : 0;
  }
  EXPECT_EQ(clips, 6) << "three demonstrations, both orders";
  EXPECT_THROW(write_ro_crate(folder / "answers", folder / "clips", folder / "crate"),
               std::runtime_error)
      << "is there already";
  write_text(folder / "clips/01-first.left-pinch.mp4", "another");
  EXPECT_THROW(write_ro_crate(folder / "answers", folder / "clips", folder / "other"), InputError);
  fs::remove(folder / "clips/01-first.left-pinch.mp4");
  EXPECT_THROW(write_ro_crate(folder / "answers", folder / "clips", folder / "other"), InputError);
  EXPECT_FALSE(fs::exists(folder / "other"));
}

TEST(Exports, NothingIsNoExport) {
  const fs::path folder = scratch_folder();
  fs::create_directories(folder / "answers/.running");
  for (const char* what : {"csv", "participants-csv", "bids", "psych-ds"}) {
    const std::string line = std::string("'") + PINCHLAB_PROGRAM + "' study export --answers '" +
                             (folder / "answers").string() + "' --" + what + " '" +
                             (folder / "out").string() + "' 2> '" + (folder / "err.txt").string() +
                             "'";
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 1) << what;
    EXPECT_NE(read_whole(folder / "err.txt").find("there is nothing to export"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder / "out")) << what;
  }
}

}  // namespace
}  // namespace pinchlab::study
