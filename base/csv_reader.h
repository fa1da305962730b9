// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pinchlab {

/// Reads a CSV file (RFC 4180) record by record through one fixed buffer, so that memory does not
/// grow with the file. Quoted fields, CRLF, a UTF-8 byte-order mark and blank lines are understood;
/// a record of more than 1 MiB or an unclosed quote throws InputError.
class CsvReader {
 public:
  /// Opens the file; throws InputError if that fails. `separator` stands between fields.
  CsvReader(const std::filesystem::path& path, char separator);

  /// Puts the next record's fields into `fields`: false at the end of the file. The views hold
  /// until the next call.
  bool next(std::vector<std::string_view>& fields);

  /// The line (from 1) at which the last record began.
  [[nodiscard]] size_t line() const { return record_line_; }

  /// "file:line" of the last record, for messages.
  [[nodiscard]] std::string place() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  // Brings one whole record to buffer_[begin_, begin_ + length) and counts its line ends; false at
  // the end.
  bool find_record(size_t& length);
  bool fill();
  void split(char* begin, char* end, std::vector<std::string_view>& fields) const;

  std::string name_;
  char separator_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_;
  size_t begin_ = 0;        // first unread byte of buffer_
  size_t end_ = 0;          // one past its last byte
  bool at_end_ = false;     // the file has no more bytes
  size_t next_line_ = 1;    // line number at begin_
  size_t record_line_ = 0;  // line number of the last record
};

}  // namespace pinchlab
