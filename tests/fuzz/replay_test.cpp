// SPDX-License-Identifier: GPL-3.0-or-later
// All that fuzzing starts from (corpus), and all that it ever found (found), as ordinary tests.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string_view>

#include "tests/fuzz/targets.h"

namespace pinchlab::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::exists(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Fuzz : public ::testing::TestWithParam<Target> {
 protected:
  struct Replayed {
    int files = 0, used = 0;  // used: not refused
  };
  static Replayed replay(const char* kind) {
    const fs::path folder = fs::path(PINCHLAB_SOURCE_DIR) / "tests" / "fuzz" / kind;
    Replayed replayed;
    for (const fs::path& file : files_in(folder / GetParam().name)) {
      SCOPED_TRACE(file.string());
      ++replayed.files;
      EXPECT_NO_THROW(replayed.used += GetParam().run(bytes_of(file)) ? 1 : 0);
    }
    return replayed;
  }
};

// Fuzzing that starts from nothing but refused files hardly comes past the door.
TEST_P(Fuzz, CorpusHolds) {
  EXPECT_GT(replay("corpus").used, 0);
}

// Each finding is a file; some are refused now.
TEST_P(Fuzz, WhatWasFoundHolds) {
  const std::map<std::string_view, int> found = {{"world", 7}, {"sweep", 1}};
  const auto of_this = found.find(GetParam().name);
  EXPECT_EQ(replay("found").files, of_this == found.end() ? 0 : of_this->second)
      << "a new finding raises this number";
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, ::testing::ValuesIn(targets),
                         [](const auto& test) { return std::string(test.param.name); });

// What is not mended yet is told at least, from early on: later steps take seconds each.
TEST(OpenFindings, AreTold) {
  const fs::path folder = fs::path(PINCHLAB_SOURCE_DIR) / "tests" / "fuzz" / "open" / "world";
  const std::vector<fs::path> files = files_in(folder);
  EXPECT_EQ(files.size(), 1U) << "README.md beside it says what each does";
  for (const fs::path& path : files) {
    EXPECT_FALSE(told_of_world(bytes_of(path), 50).empty()) << path;
  }
}

}  // namespace
}  // namespace pinchlab::fuzz
