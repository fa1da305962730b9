// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The command line of the study.

#include <CLI/App.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "study/clips.h"

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

/// Adds `study` with its commands.
void add_commands(CLI::App& app, const Stimuli& stimuli);

}  // namespace pinchlab::study
