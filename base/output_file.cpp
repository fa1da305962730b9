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

// A device or a pipe, say.
bool is_special(const std::filesystem::path& path) {
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
  if (!is_special(path)) {
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
