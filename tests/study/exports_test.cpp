// SPDX-License-Identifier: GPL-3.0-or-later
// Answers as tables of participants and as a BIDS dataset.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "base/read_file.h"
#include "study/answers.h"
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

}  // namespace
}  // namespace pinchlab::study
