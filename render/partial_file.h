// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A file that gets its name only when it is complete.

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace pinchlab {

/// The file is written as name() in the folder of its final path; keep() renames it, the destructor
/// removes it otherwise.
class PartialFile {
 public:
  /// Throws std::runtime_error if the folder does not exist or the path is a folder.
  explicit PartialFile(std::string path) : path_(std::move(path)), name_(path_ + ".partial") {
    const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder)) {
      throw std::runtime_error(path_ + ": the folder " + folder.string() +
                               " does not exist; create it first");
    }
    if (std::filesystem::is_directory(path_)) {
      throw std::runtime_error(path_ + ": is a folder; give a file's name");
    }
  }
  ~PartialFile() {
    std::error_code ignored;
    if (!kept_) std::filesystem::remove(name_, ignored);
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& name() const { return name_; }

  void keep() {
    std::error_code error;
    std::filesystem::rename(name_, path_, error);
    if (error) throw std::runtime_error(path_ + ": cannot be put in place: " + error.message());
    kept_ = true;
  }

  /// An error about this file with the system's reason.
  std::runtime_error error(const std::string& what) const {
    return std::runtime_error(path_ + ": " + what + ": " + std::generic_category().message(errno));
  }

 private:
  std::string path_, name_;
  bool kept_ = false;
};

}  // namespace pinchlab
