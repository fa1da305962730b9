// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace pinchlab::experiments {

struct RenderRun {
  std::filesystem::path scene;    ///< empty: all of demos
  std::string method = "pinch";   ///< or "baseline", each scene's own
  int width = 960, height = 960;  ///< px
  int frames = 0;                 ///< 0: all of each clip
  std::filesystem::path out;      ///< folder for render.csv and render.md; empty: neither
  std::string command;            ///< what was typed, for the files
};

/// What a frame of a clip costs, stage by stage, in processor time: told on standard output.
void run_render(const RenderRun& run);

}  // namespace pinchlab::experiments
