// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Folders of short scenes, and calls that render them.

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "run_program.h"
#include "tests/demos/scenes/scene_files.h"

namespace pinchlab {

inline std::filesystem::path folder_with_scene() {
  std::filesystem::path folder = scratch_folder();
  std::ofstream(folder / "01-small.json") << small_scene();
  return folder;
}

inline void write_scene(const std::filesystem::path& path, double duration_s) {
  nlohmann::json scene = small_scene();
  scene["duration_s"] = duration_s;
  std::ofstream(path) << scene.dump(1);
}

// Two short scenes as demos/ of the folder.
inline std::filesystem::path folder_with_demos() {
  std::filesystem::path folder = scratch_folder();
  std::filesystem::create_directory(folder / "demos");
  write_scene(folder / "demos/01-long.json", 2.0);
  write_scene(folder / "demos/02-short.json", 0.5);
  std::ofstream(folder / "demos/scene.schema.json") << "{}";  // not a demonstration
  return folder;
}

inline std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files[entry.path().filename().string()] = text_of(entry.path());
  }
  return files;
}

inline std::set<std::string> names_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& [name, bytes] : files_in(folder)) {
    names.insert(name);
  }
  return names;
}

inline const std::vector<std::string> render = {"render", "--size", "64x64"};

inline std::vector<std::string> render_with(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = render;
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace pinchlab
