// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The strict reader of scene files; demos/README.md documents the format key by key.

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "demos/scenes/scene_problem.h"
#include "demos/scenes/timing.h"
#include "render/picture/look.h"
#include "sim/scene_error.h"
#include "sim/world.h"

namespace pinchlab {

/// A scene file that cannot be used. what() has one line a problem, "file: place: message".
struct SceneFileError : std::runtime_error {
  SceneFileError(const std::string& file, std::vector<SceneProblem> problems_);
  std::vector<SceneProblem> problems;
};

/// A scene and what else its file says.
struct SceneFile {
  std::filesystem::path path;             ///< as given by the caller
  std::string sha256;                     ///< of the file's bytes, 64 hexadecimal digits
  Scene scene;                            ///< bodies, cables and walls in the file's order
  SceneLook look;                         ///< what the file says of looks
  double poster_time = 0.0;               ///< s, when the pair's poster shows it
  std::vector<ChosenNodes> chosen_nodes;  ///< in the order of the cables that run over bodies, then
                                          ///< of those that do not
};

/// Reads and checks a scene file. Nothing is guessed: throws SceneFileError with all mistakes of
/// form (keys, types, ranges), or, where the form is right, with all mistakes of meaning (names,
/// kinds, numbers that do not go together). Whether the geometry can exist is for start_world to
/// say. The scene gets `timing` before its nodes, which are such as its steps can follow; throws as
/// with_timing.
SceneFile read_scene_file(const std::filesystem::path& path, const Timing& timing = {});

/// The same for text that is in memory already; `path` names it in errors and gives the scene's
/// name.
SceneFile parse_scene(std::string_view text, const std::filesystem::path& path,
                      const Timing& timing = {});

/// What `make` returns for the scene of the file at `path`; where it throws SceneError, because the
/// geometry cannot exist, throws SceneFileError with the file's name.
template <class Make>
auto for_file(const std::filesystem::path& path, Make make) {
  try {
    return make();
  } catch (const SceneError& error) {
    throw SceneFileError(path.string(), {{error.place, error.message}});
  }
}

/// make_world for a scene that comes from the file at `path`, as for_file.
World start_world(const Scene& scene, const std::filesystem::path& path,
                  const Configuration& configuration);

}  // namespace pinchlab
