// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/read_file.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/input_error.h"

namespace pinchlab {

void read_by_pieces(const std::filesystem::path& path,
                    const std::function<void(std::string_view)>& take) {
  const auto fail = [&path](const char* what) {
    throw InputError(path.string(), fmt::format("{}: {}", what, std::strerror(errno)));
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"),
                                                             &std::fclose);
  if (!file) {
    fail("cannot be opened");
  }
  std::array<char, 1U << 16U> buffer;  // bytes; filled before it is read
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    take({buffer.data(), got});
  }
  if (std::ferror(file.get()) != 0) {
    fail("cannot be read");
  }
}

std::string read_whole(const std::filesystem::path& path, std::size_t limit_bytes) {
  std::string bytes;
  read_by_pieces(path, [&](std::string_view piece) {
    if (piece.size() > limit_bytes - bytes.size()) {
      throw InputError(path.string(), fmt::format("is larger than {} bytes", limit_bytes));
    }
    bytes += piece;
  });
  return bytes;
}

}  // namespace pinchlab
