// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <fstream>

#include "tests/base/temporary_folder.h"
#include "tests/fuzz/targets.h"

namespace pinchlab::fuzz {

namespace fs = std::filesystem;

const fs::path& scratch_folder() {
  static const test::TemporaryFolder folder;  // removed at the end of the process
  static const fs::path path = folder.path();
  return path;
}

fs::path file_with(std::string_view bytes, const std::string& name) {
  fs::path path = scratch_folder() / name;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw std::system_error(errno, std::generic_category(), path.string());
  return path;
}

void must_name(const std::exception& error, const std::string& file) {
  if (!std::string_view(error.what()).starts_with(file)) {
    throw Finding(fmt::format("an error that does not name the file: {}", error.what()));
  }
}

}  // namespace pinchlab::fuzz
