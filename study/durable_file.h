// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Files that survive: whole or absent whatever happens to the process or the power.

#include <filesystem>
#include <string>
#include <string_view>

namespace pinchlab::study {

/// Ending of what is not finished; a leftover of an interrupted write is never an answer.
inline constexpr std::string_view partial_ending = ".partial";

/// Writes `bytes` under a temporary name, brings them to the disk, reads them back, renames, and
/// brings the folder to the disk. When it returns, the file is there for good. Throws
/// std::runtime_error with the path and the reason; then the file is as it was before.
void write_durably(const std::filesystem::path& path, std::string_view bytes);

/// Removes a file if it is there, and brings the folder to the disk.
void remove_durably(const std::filesystem::path& path);

/// The whole file. Throws std::runtime_error.
std::string read_whole(const std::filesystem::path& path);

}  // namespace pinchlab::study
