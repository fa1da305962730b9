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
#include "tests/study/server_process.h"

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

inline void write_clips(const std::filesystem::path& folder) {
  write_clips(folder, demonstrations, 100000);
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
