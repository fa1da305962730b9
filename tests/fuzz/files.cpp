// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

#include "tests/fuzz/targets.h"

namespace pinchlab::fuzz {
namespace {

namespace fs = std::filesystem;

/// Removed at the end of the process.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("pinchlab-fuzz-{}", ::getpid())) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

fs::path file_with(std::string_view bytes, const std::string& name) {
  static const Folder folder;
  fs::path path = folder.path() / name;
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
