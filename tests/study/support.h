// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A folder of clips that are no videos: the server does not look into them.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/sha256.h"
#include "study/desk.h"
#include "study/secrets.h"

namespace pinchlab::study {

inline const std::vector<std::string> demonstrations = {"01-first", "02-second", "03-third"};

/// A folder of this test's own, empty at first.
inline std::filesystem::path scratch_folder() {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "pinchlab-study" /
                                 (std::string(test->test_suite_name()) + "." + test->name());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Pairs of files of different sizes, and their manifest.
inline void write_clips(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  nlohmann::json clips = nlohmann::json::array();
  std::size_t size = 100000;
  for (const std::string& name : demonstrations) {
    for (const char* left : {"pinch", "baseline"}) {
      const std::string file = name + ".left-" + left + ".mp4";
      std::string bytes(size += 777, '\0');
      for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<char>((i * i + size) % 251);
      }
      write_text(folder / file, bytes);
      clips.push_back({{"file", file}, {"sha256", sha256(bytes)}});
    }
  }
  write_text(folder / "manifest.json",
             nlohmann::json{{"format", "pinchlab clips 1"}, {"clips", clips}}.dump());
}

inline Config small_config() {
  Config config = default_config();
  config.demonstrations = demonstrations;
  return config;
}

inline DeskOptions desk_options(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "clips")) {
    write_clips(folder / "clips");
  }
  DeskOptions options;
  options.config = small_config();
  options.clips = open_clips(folder / "clips", options.config);
  options.answers = folder / "answers";
  options.seed = 7;
  return options;
}

inline nlohmann::json answer_body(std::size_t index, const char* choice = "left") {
  return {{"index", index},          {"choice", choice},
          {"reaction_time_s", 1.25}, {"loops_watched", 2},
          {"focus_lost_count", 0},   {"frame_count", 900},
          {"dropped_frames", 3},     {"loop_gap_median_s", 0.001},
          {"loop_gap_max_s", 0.017}, {"playback_errors", nlohmann::json::array()},
          {"input", "mouse"},        {"encoding", "mp4"},
          {"window_width_px", 1280}, {"window_height_px", 720},
          {"clip_width_px", 1200},   {"clip_height_px", 600},
          {"screen_width_px", 1920}, {"screen_height_px", 1080},
          {"device_pixel_ratio", 1}};
}

/// The status with which the desk refuses what `action` asks of it, or 0.
template <class Action>
int refused(const Action& action) {
  try {
    action();
  } catch (const Refused& error) {
    return error.status;
  }
  return 0;
}

}  // namespace pinchlab::study
