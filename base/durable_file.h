// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Files that survive: whole or absent whatever happens to the process or the power.

#include <filesystem>
#include <string_view>

namespace pinchlab {

/// Writes `bytes`, which only the user may read, under a temporary name, brings them to the disk,
/// reads them back, renames, and brings the folder to the disk. When it returns, the file is there
/// for good. Throws std::runtime_error with the path and the reason; then the file is as it was
/// before.
void write_durably(const std::filesystem::path& path, std::string_view bytes);

/// Removes a file if it is there, and brings the folder to the disk.
void remove_durably(const std::filesystem::path& path);

}  // namespace pinchlab
