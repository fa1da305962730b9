// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/find_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace pinchlab {

namespace fs = std::filesystem;

namespace {

bool is_demo_name(const fs::path& path) {
  const std::string name = path.filename().string();
  const auto is_digit = [](char c) { return '0' <= c && c <= '9'; };
  return name.size() > 8 && is_digit(name[0]) && is_digit(name[1]) && name[2] == '-' &&
         name.ends_with(".json");
}

}  // namespace

std::vector<fs::path> find_scenes(const std::vector<fs::path>& paths) {
  std::vector<fs::path> scenes;
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path)) {
      scenes.push_back(path);
      continue;
    }
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
      if (is_demo_name(entry.path())) {
        found.push_back(entry.path());
      }
    }
    if (found.empty()) {
      throw std::runtime_error(fmt::format("{}: has no scene called NN-name.json", path.string()));
    }
    std::ranges::sort(found);
    scenes.insert(scenes.end(), found.begin(), found.end());
  }
  return scenes;
}

}  // namespace pinchlab
