// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/partial_file.h"

namespace pinchlab {

/// Whether both are names of one file, however they are written; "-" is standard output.
bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other);

/// A file that appears under its name only when complete. "-" is standard output, and what exists
/// and is no ordinary file (/dev/null, a pipe, /dev/stdout whatever that is) is written directly,
/// on from where it is. Every function throws
/// std::runtime_error, with the name and the reason, where the file cannot be written.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();  ///< removes what is not complete
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  /// Brings everything to the disk and gives the file its name.
  void finish();

 private:
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path path_;
  std::optional<PartialFile> partial_;  // none when written directly
  std::FILE* file_ = nullptr;
};

/// Throws std::runtime_error where a file cannot be written, as writing it would: before long work.
/// Leaves nothing.
void check_can_be_written(const std::filesystem::path& path);

/// Writes a whole result: to standard output where `path` is "-", into what exists and is no
/// ordinary file, and elsewhere so that it survives (write_durably), with `mode` less the umask:
/// only_the_user for answers. Throws std::runtime_error.
void write_result(const std::filesystem::path& path, std::string_view text, mode_t mode = 0666);

/// The same to standard output.
void print_result(std::string_view text);

}  // namespace pinchlab
