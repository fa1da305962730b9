// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <utility>

#include "base/durable_file.h"
#include "base/why_not_written.h"

namespace pinchlab {

namespace {

// One that the process holds open: /dev/stdout, /dev/fd/3. Such a file is not to be replaced by
// another, nor is the link, which is the whole machine's.
bool is_open_already(std::filesystem::path path) {
  std::error_code none;
  for (int i = 0; i < 40 && std::filesystem::is_symlink(path, none); ++i) {
    const std::string folder = std::filesystem::canonical(path.parent_path(), none).string();
    if (folder.starts_with("/proc/") && folder.ends_with("/fd")) return true;
    path = path.parent_path() / std::filesystem::read_symlink(path, none);
  }
  return false;
}

// A device or a pipe, say.
bool is_special(const std::filesystem::path& path) {
  if (is_open_already(path)) return true;
  std::error_code none;
  const auto status = std::filesystem::status(path, none);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

}  // namespace

bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other) {
  if (one.empty() || other.empty()) return false;
  if (one == "-" || other == "-") return one == other;
  std::error_code none;
  const auto whole = [&none](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(
        std::filesystem::absolute(where_links_lead(path), none), none);
  };
  return whole(one) == whole(other);
}

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path) {
  if (path == "-") {
    path_ = "standard output";
    file_ = stdout;
    return;
  }
  if (!is_special(path)) {
    partial_.emplace(path.string());
  }
  file_ = partial_ ? std::fopen(partial_->name().c_str(), "wb") : std::fopen(path_.c_str(), "ab");
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
  throw std::runtime_error(fmt::format("{}: {}: {}", path_.string(), what, why_not_written(errno)));
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

void write_result(const std::filesystem::path& path, std::string_view text) {
  if (path != "-" && !is_special(path)) return write_durably(path, text);
  OutputFile out(path);
  out.write(text);
  out.finish();
}

void print_result(std::string_view text) {
  write_result("-", text);
}

}  // namespace pinchlab
