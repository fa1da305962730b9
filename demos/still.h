// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "demos/scenes/scene_json.h"
#include "demos/scenes/theme.h"
#include "render/picture/scenery.h"

namespace pinchlab {

struct StillOptions {
  /// Each "t" or "from:to" in s, shown by the nearest frame, or by all frames from one to the
  /// other; or several of these with commas between
  std::vector<std::string> times;
  std::vector<Configuration> methods;  ///< one a row of the sheet
  int width = 960, height = 960;       ///< px, of one picture
  bool neutral = false;                ///< label rows A and B rather than by method
  bool burn_time = false;              ///< the time in a corner of each picture
  ThemeFile theme;
  std::filesystem::path out;  ///< .png, .svg or .pdf; with a # in its name: a PNG for each frame
  std::optional<double> time_limit;  ///< s of work on one method, after which it is given up
};

/// The frames that `times` name, in their order. Throws std::invalid_argument for what is no time
/// of the scene.
std::vector<int> frames_at(const Scene& scene, const std::vector<std::string>& times);

/// set_scenery for a scene of `file`, and tells on standard error how far its rehearsal is. Throws
/// SceneFileError where the geometry cannot exist, GivenUp.
Scenery set_scenery_aloud(const SceneFile& file, const Scene& scene, const StillOptions& options);

/// Throws std::invalid_argument, with `cure`, if a PNG of so many pictures of the options' size is
/// more than a sheet may hold.
void check_sheet_size(std::size_t pictures, const StillOptions& options, const std::string& cure);

/// One frame of a scene as PNG, SVG or PDF, or, for several times or methods, a contact sheet with
/// a label under each frame. A # in the name of a PNG file stands for the frame's number: each
/// frame is a file of its own. Throws std::invalid_argument for a time outside of the clip or
/// another ending, std::runtime_error where the simulation, the drawing or the file fails.
void write_still(const SceneFile& file, const StillOptions& options);

}  // namespace pinchlab
