// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace pinchlab {

/// The scene files that `paths` name, in order: a folder stands for its NN-name.json, NN two
/// digits. Throws std::runtime_error if a folder has none.
std::vector<std::filesystem::path> find_scenes(const std::vector<std::filesystem::path>& paths);

}  // namespace pinchlab
