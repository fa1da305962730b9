// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <utility>

#include "base/durable_file.h"
#include "base/text_checks.h"
#include "base/why_not_written.h"

namespace pinchlab {

namespace {

// The descriptor of what the process holds open, by /dev/stdout, say, or /dev/fd/3. What is opened
// anew by such a name has a place of its own to write at. Neither is that file to be replaced by
// another, nor the link, which is the whole machine's.
std::optional<int> open_descriptor(std::filesystem::path path) {
  std::error_code none;
  const std::filesystem::path mine = std::filesystem::canonical("/proc/self/fd", none);
  for (int i = 0; i < 40 && std::filesystem::is_symlink(path, none); ++i) {
    if (!mine.empty() && std::filesystem::canonical(path.parent_path(), none) == mine) {
      const std::optional<long> number = parse_whole(path.filename().string(), 0, 1'000'000);
      return number ? std::optional(static_cast<int>(*number)) : std::nullopt;
    }
    path = path.parent_path() / std::filesystem::read_symlink(path, none);
  }
  return std::nullopt;
}

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
  if (const std::optional<int> open = open_descriptor(path)) {
    const int mine = ::dup(*open);
    file_ = mine < 0 ? nullptr : ::fdopen(mine, "wb");
  } else if (is_special(path)) {
    file_ = std::fopen(path_.c_str(), "wb");
  } else {
    partial_.emplace(path.string());
    file_ = std::fopen(partial_->name().c_str(), "wb");
  }
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

void check_can_be_written(const std::filesystem::path& path) {
  if (path != "-" && !open_descriptor(path) && !is_special(path)) const PartialFile probe(path);
}

void write_result(const std::filesystem::path& path, std::string_view text, mode_t mode) {
  if (path != "-" && !open_descriptor(path) && !is_special(path)) {
    return write_durably(path, text, mode);
  }
  OutputFile out(path);
  out.write(text);
  out.finish();
}

void print_result(std::string_view text) {
  write_result("-", text);
}

}  // namespace pinchlab
