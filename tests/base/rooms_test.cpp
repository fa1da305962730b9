// SPDX-License-Identifier: GPL-3.0-or-later
// The rooms know each other one way only, and outside of sim/ no two files need each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "base/read_file.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using Graph = std::map<std::string, std::set<std::string>>;

// The rooms that each may know, besides itself. README.md tells the same.
const Graph may_know = {
    {"base", {}},
    {"sim", {"base", "sim/cable", "sim/detect", "sim/motion", "sim/solve", "sim/thesis"}},
    {"sim/cable", {"base", "sim"}},
    {"sim/detect", {"base", "sim", "sim/cable"}},
    {"sim/motion", {"base", "sim", "sim/cable", "sim/detect", "sim/solve"}},
    {"sim/solve", {"base", "sim", "sim/cable"}},
    {"sim/thesis", {"base", "sim", "sim/cable", "sim/solve"}},
    {"render/picture", {"base", "sim", "sim/cable"}},
    {"demos/scenes", {"base", "sim", "render/picture"}},
    {"render", {"base", "sim", "sim/cable", "render/picture"}},
    {"demos", {"base", "sim", "sim/cable", "render/picture", "demos/scenes", "render"}},
    {"analysis", {"base"}},
    {"study", {"base"}},
    {"analysis/experiments",
     {"base", "sim", "sim/cable", "sim/detect", "sim/solve", "render/picture", "demos/scenes",
      "render", "demos", "analysis", "study"}},
};

// The longest of the rooms' names that begins the path; empty if it is in none.
std::string room_of(const std::string& path) {
  std::string longest;
  for (const auto& [room, known] : may_know) {
    if (path.starts_with(room + "/") && room.size() > longest.size()) longest = room;
  }
  return longest;
}

// Source and header of one name are one unit.
std::string unit_of(const fs::path& path) {
  return (path.parent_path() / path.stem()).string();
}

const fs::path root = PINCHLAB_SOURCE_DIR;

// Our C++ files in these folders, from the root.
std::vector<fs::path> sources_in(const std::vector<const char*>& folders) {
  std::vector<fs::path> sources;
  for (const char* folder : folders) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path& path = entry.path();
      const bool is_source = path.extension() == ".cpp" || path.extension() == ".h";
      if (!is_source || path.string().find("node_modules") != std::string::npos) continue;
      sources.push_back(fs::relative(path, root));
    }
  }
  return sources;
}

const std::vector<const char*> top_folders = {"base",  "sim",      "render",
                                              "demos", "analysis", "study"};

// What each file of ours includes of ours: path to paths.
Graph includes() {
  const std::regex line(R"re(^#include "([^"]+)")re");
  Graph graph;
  for (const fs::path& path : sources_in(top_folders)) {
    std::set<std::string>& of_file = graph[path.string()];
    std::istringstream text(read_whole(root / path));
    std::smatch found;
    for (std::string l; std::getline(text, l);) {
      if (std::regex_search(l, found, line)) of_file.insert(found[1]);
    }
  }
  return graph;
}

TEST(Rooms, KnowEachOtherOneWay) {
  const Graph graph = includes();
  ASSERT_GT(graph.size(), 100U);
  for (const auto& [file, included] : graph) {
    for (const std::string& other : included) {
      const std::string from = room_of(file), to = room_of(other);
      ASSERT_NE(from, "") << file;
      EXPECT_NE(to, "") << file << " includes " << other << " by a path that is not the project's";
      if (to.empty() || from == to) continue;
      EXPECT_TRUE(may_know.at(from).contains(to)) << file << " includes " << other;
    }
  }
}

// The table above has no circle but the one between sim/ and its sub-rooms, whose step() calls them
// and whose data they read.
TEST(Rooms, TheTableHasNoCircles) {
  Graph rooms = may_know;
  for (const char* inside : {"sim/cable", "sim/detect", "sim/motion", "sim/solve", "sim/thesis"}) {
    rooms.at("sim").erase(inside);
  }
  while (std::erase_if(rooms, [&rooms](const auto& room) {
    return std::ranges::none_of(room.second,
                                [&](const std::string& other) { return rooms.contains(other); });
  })) {
  }
  EXPECT_TRUE(rooms.empty()) << rooms.begin()->first;
}

// Inside of sim/: its data and their geometry, then what a step consists of, in the order of the
// step, then what makes, steps and watches worlds. An arrow runs upward where a file includes one
// of a level above its own.
int level_in_sim(const std::string& file) {
  const std::map<std::string, int> of_room = {
      {"sim/cable", 1}, {"sim/detect", 2}, {"sim/solve", 3}, {"sim/thesis", 4}, {"sim/motion", 5}};
  const auto room = of_room.find(room_of(file));
  if (room != of_room.end()) return room->second;
  if (file == "sim/parts.cpp" || unit_of(file) == "sim/diagnostics" ||
      unit_of(file) == "sim/energy") {
    return of_room.at("sim/cable");
  }
  for (const char* above : {"sim/at_steps", "sim/energy_watch", "sim/first_tensions", "sim/joints",
                            "sim/make_world", "sim/node_count", "sim/nodes", "sim/promises",
                            "sim/scene_checks", "sim/scene_figures", "sim/step"}) {
    if (unit_of(file) == above) return 6;
  }
  return 0;
}

TEST(Rooms, InSimOnlyTheWorkspaceLooksUp) {
  std::set<std::string> upward;
  for (const auto& [file, included] : includes()) {
    if (!file.starts_with("sim/")) continue;
    for (const std::string& other : included) {
      if (!other.starts_with("sim/") || level_in_sim(other) <= level_in_sim(file)) continue;
      upward.insert(file + " -> " + other);
    }
  }
  // It holds what each of the rooms keeps from step to step.
  const std::set<std::string> storage = {"sim/workspace.h -> sim/detect/broad_phase.h",
                                         "sim/workspace.h -> sim/diagnostics.h",
                                         "sim/workspace.h -> sim/motion/neighbourhoods.h",
                                         "sim/workspace.h -> sim/solve/part_system.h",
                                         "sim/workspace.h -> sim/solve/solve_scratch.h",
                                         "sim/workspace.h -> sim/thesis/sweep_scratch.h"};
  EXPECT_EQ(upward, storage);
}

// Takes away again and again what includes nothing that is left; what stays goes round in a circle,
// or includes what does.
TEST(Rooms, NoIncludesGoRoundInACircle) {
  Graph units;
  for (const auto& [file, included] : includes()) {
    if (file.starts_with("sim/")) continue;  // whose data and stages still need each other
    std::set<std::string>& of_unit = units[unit_of(file)];
    for (const std::string& other : included) {
      if (unit_of(other) != unit_of(file)) of_unit.insert(unit_of(other));
    }
  }
  ASSERT_GT(units.size(), 50U);
  while (std::erase_if(units, [&units](const auto& unit) {
    return std::ranges::none_of(unit.second,
                                [&](const std::string& other) { return units.contains(other); });
  })) {
  }
  std::string circles;
  for (const auto& [unit, others] : units) {
    for (const std::string& other : others) {
      if (units.contains(other)) circles += "\n" + unit + " -> " + other;
    }
  }
  EXPECT_EQ(circles, "");
}

// clang-format wraps code only: what it would do to comments breaks formulas.
TEST(Comments, FitIntoOneHundredColumns) {
  const std::regex comment(R"re(^\s*//.*)re");
  std::string longer;
  int comments = 0;
  std::vector<const char*> folders = top_folders;
  folders.push_back("tests");
  for (const fs::path& path : sources_in(folders)) {
    std::istringstream text(read_whole(root / path));
    int number = 0;
    for (std::string line; std::getline(text, line); ++number) {
      if (!std::regex_match(line, comment)) continue;
      ++comments;
      const auto columns =
          std::ranges::count_if(line, [](char c) { return (c & 0xc0) != 0x80; });  // UTF-8
      if (columns > 100) longer += "\n" + path.string() + ":" + std::to_string(number + 1);
    }
  }
  EXPECT_GT(comments, 5000);
  EXPECT_EQ(longer, "");
}

// Types that a file defines for others: names with their namespaces.
std::vector<std::string> types_in(const fs::path& path) {
  const std::regex opens(R"re(^namespace ([\w:]*) ?\{)re"), closes(R"re(^\}  // namespace)re");
  const std::regex type(R"re(^(struct|class|enum class|enum) (alignas\(\d+\) )?(\w+)[^;]*\{)re");
  std::vector<std::string> types, spaces;
  std::istringstream text(read_whole(root / path));
  for (std::string line; std::getline(text, line);) {
    std::smatch match;
    if (std::regex_search(line, match, opens)) {
      spaces.push_back(match[1]);
    } else if (std::regex_search(line, closes) && !spaces.empty()) {
      spaces.pop_back();
    } else if (std::regex_search(line, match, type) &&
               std::ranges::find(spaces, "") == spaces.end()) {
      std::string name;
      for (const std::string& space : spaces) name += space + "::";
      types.push_back(name + match[3].str());
    }
  }
  return types;
}

// Two types of one name in one namespace, in different files, are undefined behaviour where both
// are in one program: what the compiler makes of the one's vectors serves the other's. (`Trial`
// was once an answer's in base/ and an interval's in sim/, and a reader wrote behind its memory.)
TEST(Rooms, NoTwoTypesHaveOneName) {
  Graph units;  // where each is defined
  for (const fs::path& path : sources_in(top_folders)) {
    for (const std::string& name : types_in(path)) units[name].insert(unit_of(path));
  }
  EXPECT_GT(units.size(), 200U);
  for (const auto& [name, where] : units) {
    // One written for two libraries: FFmpeg's and another.
    if (where.contains("render/video")) continue;
    EXPECT_EQ(where.size(), 1U) << name << " is in " << *where.begin() << " and "
                                << *where.rbegin();
  }
}

}  // namespace
}  // namespace pinchlab
