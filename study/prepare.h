// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What has to be there before a study begins: its configuration, and all of its clips.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "study/clips.h"
#include "study/config.h"

namespace pinchlab::study {

/// What the study asks of others, so that it need not know them.
struct Stimuli {
  /// The demonstrations there are to show; empty if there is no folder of them here.
  std::function<std::vector<std::string>()> demonstrations;
  /// Makes the side-by-side clips of some of them. Throws std::runtime_error.
  std::function<void(const std::vector<std::string>& names, PairKind kind,
                     const std::filesystem::path& folder, Encoding encoding)>
      render;
};

/// The configuration of a file, or the one without a file if `path` is empty.
Config read_or_default(const std::filesystem::path& path);

/// Names the demonstrations of a configuration that names none, renders the clips that are missing
/// and can be rendered (MP4, and WebM unless `no_webm`), opens all, and warns of same_clips() on
/// standard error. Throws std::runtime_error with the cure, also if the program was built without
/// the page.
Clips prepare(Config& config, const Stimuli& stimuli, const std::filesystem::path& clips,
              bool no_webm);

}  // namespace pinchlab::study
