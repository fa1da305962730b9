// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Files that survive: whole or absent whatever happens to the process or the power.

#include <sys/types.h>

#include <filesystem>
#include <string_view>

namespace pinchlab {

/// The mode of files with answers.
inline constexpr mode_t only_the_user = 0600;

/// Writes `bytes`, to a file of this mode less the umask, under a temporary name, brings them to
/// the disk, reads them back, renames, and brings the folder to the disk. When it returns, the file
/// is there for good. Throws std::runtime_error with the path and the reason; then the file is as
/// it was before.
void write_durably(const std::filesystem::path& path, std::string_view bytes,
                   mode_t mode = only_the_user);

/// Removes a file if it is there, and brings the folder to the disk.
void remove_durably(const std::filesystem::path& path);

}  // namespace pinchlab
