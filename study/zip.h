// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/partial_file.h"

struct archive;

namespace pinchlab::study {

/// Writes a zip archive entry by entry (libarchive's: deflated, zip64 where it must be). The file
/// has its name when finish() has returned; before, and for good if that never happens, nothing
/// has.
class ZipWriter {
 public:
  /// Throws std::runtime_error if the file cannot be made, as all others do for a full disk.
  explicit ZipWriter(const std::filesystem::path& path);

  /// `name` is a path with slashes, UTF-8. All entries have the same date, so that it tells
  /// nothing.
  void add(const std::string& name, std::string_view bytes);
  void finish();

 private:
  struct Free {
    void operator()(archive* writer) const;
  };
  void check(int result) const;

  PartialFile partial_;
  std::unique_ptr<archive, Free> writer_;
};

}  // namespace pinchlab::study
