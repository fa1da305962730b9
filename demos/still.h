// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "demos/scene_json.h"

namespace pinchlab {

struct StillOptions {
  std::vector<double> times;           ///< s, each shown by the nearest frame; any order
  std::vector<Configuration> methods;  ///< one a row of the sheet
  int width = 960, height = 960;       ///< px, of one picture
  std::filesystem::path out;           ///< PNG
};

/// One frame of a scene as PNG, or, for several times or methods, a contact sheet with a label
/// under each frame. Throws std::invalid_argument for a time outside of the clip,
/// std::runtime_error where the simulation, OpenGL or the file fails.
void write_still(const SceneFile& file, const StillOptions& options);

}  // namespace pinchlab
