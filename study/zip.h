// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Archives as PKWARE's APPNOTE.TXT 6.3 describes them: deflated entries, no more than 4 GiB.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace pinchlab::study {

/// Writes an archive entry by entry. The file has its name when finish() has returned; before, and
/// for good if that never happens, nothing has.
class ZipWriter {
 public:
  /// Throws std::runtime_error if the file cannot be made, as all others do for a full disk.
  explicit ZipWriter(std::filesystem::path path);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// `name` is a path with slashes. All entries have the same date, so that it tells nothing.
  void add(const std::string& name, std::string_view bytes);
  void finish();

 private:
  struct Entry {
    std::string name;
    std::uint32_t crc, packed_size, size, offset;  // bytes
  };
  void write(std::string_view bytes);

  std::filesystem::path path_, partial_;
  std::ofstream file_;
  std::uint64_t written_ = 0;  // bytes
  std::vector<Entry> entries_;
};

}  // namespace pinchlab::study
