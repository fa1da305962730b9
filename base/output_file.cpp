// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace pinchlab {

bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other) {
  if (one.empty() || other.empty()) return false;
  if (one == "-" || other == "-") return one == other;
  std::error_code none;
  const auto whole = [&none](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, none), none);
  };
  return whole(one) == whole(other);
}

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path) {
  if (path == "-") {
    path_ = "standard output";
    file_ = stdout;
    return;
  }
  std::error_code none;
  const auto status = std::filesystem::status(path, none);
  const bool is_special = std::filesystem::exists(status) &&
                          !std::filesystem::is_regular_file(status) &&
                          !std::filesystem::is_directory(status);
  if (!is_special) {
    partial_.emplace(path.string());
  }
  file_ = std::fopen(partial_ ? partial_->name().c_str() : path_.c_str(), "wb");
  if (file_ == nullptr) {
    fail("cannot be written");
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr && file_ != stdout) {
    std::fclose(file_);
  }
}

void OutputFile::fail(const char* what) const {
  throw std::runtime_error(fmt::format("{}: {}: {}", path_.string(), what, std::strerror(errno)));
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) {
    fail("cannot be written");
  }
}

void OutputFile::finish() {
  if (std::fflush(file_) != 0 || (partial_ && ::fsync(::fileno(file_)) != 0)) {
    fail("cannot be written");
  }
  if (std::FILE* const file = std::exchange(file_, nullptr);
      file != stdout && std::fclose(file) != 0) {
    fail("cannot be written");
  }
  if (partial_) {
    partial_->keep();
  }
}

}  // namespace pinchlab
