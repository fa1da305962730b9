// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One output file of a batch: a clip, or the poster of a pair.

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "demos/playback.h"
#include "demos/scenes/scene_json.h"
#include "demos/scenes/theme.h"
#include "render/video.h"

namespace pinchlab {

enum class Product {
  clip,    ///< a video
  poster,  ///< one frame of each method as PNG, with labels
  report,  ///< figures of the pair in the manifest (pair_report.h), and a strip of it as PNG
};

/// Everything that a file's bytes depend on.
struct ClipPlan {
  std::string file;  ///< name in the output folder, e.g. "03-drop.pinch.mp4"
  /// "pinch", "baseline", "left-pinch", "left-baseline", "check-left", "check-right", "poster",
  /// "report", a method, or two as "pinch-cable" from left to right
  std::string role;
  const SceneFile* source = nullptr;
  Scene scene;                         ///< the source's, with the timing to use
  std::vector<Configuration> methods;  ///< one a panel, left to right
  std::optional<int> upside_down;      ///< panel that is shown so, in attention checks
  VideoSettings video;                 ///< of the whole frame, all panels together
  ThemeFile theme;
  Playback playback;
  std::vector<std::int64_t> steps;  ///< shown by the frames of a video
  bool burn_time = false;           ///< the time in a corner of each panel
  Product product = Product::clip;
  /// The other files of its pair, that are to be as large (equal_sizes.h).
  std::vector<std::string> equal_sizes_with;
};

/// The name that make_clip gives the file: the plan's, or another one where its size is yet to be
/// made equal to others'.
std::string made_as(const ClipPlan& plan);

/// px of one panel.
int panel_width(const ClipPlan& plan);

/// Frame that the poster shows.
int poster_frame(const ClipPlan& plan);

/// What the manifest says of the plan before the file is made. Free of paths, dates and hosts.
nlohmann::ordered_json plan_entry(const ClipPlan& plan);

/// Makes the file in `folder`, as made_as says, and returns its manifest entry: the plan's, the
/// hashes, and in `broken_promises` what Player says of it, in `hard_to_see` what legibility.h
/// does, if anything. Calls `tick` after every frame. Throws std::runtime_error where the
/// simulation, the drawing or the file fails, or where one method takes longer than `time_limit`
/// (s).
nlohmann::ordered_json make_clip(const ClipPlan& plan, const std::filesystem::path& folder,
                                 const std::function<void()>& tick,
                                 std::optional<double> time_limit = std::nullopt);

}  // namespace pinchlab
