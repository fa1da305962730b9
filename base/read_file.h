// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

namespace pinchlab {

/// The whole file. Throws InputError with the path and the reason if it cannot be read, is no file,
/// or is larger than `limit_bytes` (of which no more is read).
std::string read_whole(const std::filesystem::path& path,
                       std::size_t limit_bytes = std::numeric_limits<std::size_t>::max());

/// The same piece by piece, so that memory does not grow with the file.
void read_by_pieces(const std::filesystem::path& path,
                    const std::function<void(std::string_view)>& take);

}  // namespace pinchlab
