// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/scene_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "base/sha256.h"
#include "base/strict_json.h"
#include "demos/scenes/format_check.h"
#include "demos/scenes/scene_reader.h"
#include "sim/make_world.h"

namespace pinchlab {
namespace {

using nlohmann::json;

std::string report(const std::string& file, const std::vector<SceneProblem>& problems) {
  constexpr std::size_t shown = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(problems.size(), shown); ++i) {
    const SceneProblem& problem = problems[i];
    const char* colon = problem.place.empty() ? "" : ": ";
    text += fmt::format("{}{}: {}{}{}", i == 0 ? "" : "\n", file, problem.place, colon,
                        problem.message);
  }
  if (problems.size() > shown) {
    text += fmt::format("\n{}: and {} more", file, problems.size() - shown);
  }
  return text;
}

// The name becomes part of the clips' names.
std::string scene_name(const std::filesystem::path& path) {
  std::string name = path.stem().string();
  const auto is_fine = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  };
  if (name.empty() || name.size() > 64 || !std::ranges::all_of(name, is_fine) ||
      path.extension() != ".json") {
    throw SceneFileError(path.string(),
                         {{"",
                           "a scene file is called NN-name.json: up to 64 letters, digits, "
                           "- and _, then .json; rename it"}});
  }
  return name;
}

}  // namespace

SceneFileError::SceneFileError(const std::string& file, std::vector<SceneProblem> problems_)
    : std::runtime_error(report(file, problems_)), problems(std::move(problems_)) {}

SceneFile parse_scene(std::string_view text, const std::filesystem::path& path,
                      const Timing& timing) {
  SceneFile file;
  file.path = path;
  const std::string name = scene_name(path);
  file.sha256 = sha256(text);

  std::vector<SceneProblem> problems;
  try {
    const json value = parse_strict_json(text);
    check_format(value, scene_format(), "", problems);
    if (problems.empty()) {
      SceneContent content = read_scene(value, name, timing, problems);
      file.scene = std::move(content.scene);
      file.look = std::move(content.look);
      file.poster_time = content.poster_time;
      file.chosen_nodes = std::move(content.chosen_nodes);
    }
  } catch (const JsonError& error) {
    problems.push_back({error.place, error.what()});
  }
  if (!problems.empty() && text.find("${") != std::string_view::npos) {
    problems.insert(problems.begin(),
                    {"",
                     "is a template with placeholders (${...}), whose values `pinchlab sweep` and "
                     "`pinchlab still --table` give"});
  }
  if (!problems.empty()) {
    throw SceneFileError(path.string(), std::move(problems));
  }
  return file;
}

namespace {

// What can be done where a scene file is not there: the one in its folder whose name is near.
std::string cure_of_missing(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path();
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry :
       std::filesystem::directory_iterator(folder.empty() ? "." : folder, none)) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  const std::string near = nearest_word(path.stem().string(), names);
  return near.empty() ? "; name a scene file, as those of demos/"
                      : fmt::format(" (did you mean `{}`?)", (folder / near).string() + ".json");
}

}  // namespace

SceneFile read_scene_file(const std::filesystem::path& path, const Timing& timing) {
  if (path.empty()) throw SceneFileError("the scene file's name", {{"", "is empty"}});
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    if (std::filesystem::exists(path, error)) {
      throw SceneFileError(path.string(), {{"", "is not a file"}});
    }
    const std::string why = error ? error.message() : "No such file or directory";
    throw SceneFileError(path.string(), {{"", why + cure_of_missing(path)}});
  }
  std::string text;
  try {
    text = read_whole(path, max_scene_bytes);
  } catch (const InputError& unreadable) {
    throw SceneFileError(path.string(), {{"", unreadable.message}});
  }
  return parse_scene(text, path, timing);
}

World start_world(const Scene& scene, const std::filesystem::path& path,
                  const Configuration& configuration) {
  return for_file(path, [&] { return make_world(scene, configuration); });
}

}  // namespace pinchlab
