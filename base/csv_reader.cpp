// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/csv_reader.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "base/input_error.h"

namespace pinchlab {

namespace {
constexpr size_t buffer_size = size_t{1} << 20;
}

CsvReader::CsvReader(const std::filesystem::path& path, char separator)
    : name_(path.string()), separator_(separator), file_(std::fopen(name_.c_str(), "rb")) {
  if (!file_) throw InputError(name_, fmt::format("cannot be opened: {}", std::strerror(errno)));
  buffer_.resize(buffer_size);
  fill();
  if (end_ >= 3 && std::memcmp(buffer_.data(), "\xEF\xBB\xBF", 3) == 0) begin_ = 3;
}

std::string CsvReader::place() const {
  return fmt::format("{}:{}", name_, record_line_);
}

// Moves what is unread to the front and reads on behind it; false if nothing came.
bool CsvReader::fill() {
  if (at_end_) return false;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const size_t count = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  if (std::ferror(file_.get())) {
    throw InputError(name_, fmt::format("cannot be read: {}", std::strerror(errno)));
  }
  end_ += count;
  at_end_ = count == 0;
  return count > 0;
}

bool CsvReader::find_record(size_t& length) {
  size_t scanned = 0;
  size_t newlines = 0;
  bool quoted = false;
  for (;;) {
    const char* data = buffer_.data() + begin_;
    const size_t available = end_ - begin_;
    for (; scanned < available; ++scanned) {
      if (data[scanned] == '"') quoted = !quoted;
      if (data[scanned] != '\n') continue;
      ++newlines;
      if (quoted) continue;
      length = scanned + 1;
      next_line_ += newlines;
      return true;
    }
    if (available == buffer_.size()) {
      throw InputError(fmt::format("{}:{}", name_, next_line_),
                       "a record of more than 1 MiB; is a closing quote missing?");
    }
    if (fill()) continue;
    if (quoted) throw InputError(fmt::format("{}:{}", name_, next_line_), "a quote is not closed");
    length = available;
    next_line_ += newlines;
    return available > 0;
  }
}

void CsvReader::split(char* begin, char* end, std::vector<std::string_view>& fields) const {
  fields.clear();
  char* at = begin;
  for (;;) {
    if (at < end && *at == '"') {
      // A quoted field is unquoted in place: the text only gets shorter.
      char* write = ++at;
      const char* field = write;
      for (;; ++at) {
        if (at == end) throw InputError(place(), "a quote is not closed");
        if (*at != '"') {
          *write++ = *at;
        } else if (at + 1 < end && at[1] == '"') {
          *write++ = *at++;
        } else {
          break;
        }
      }
      ++at;
      if (at < end && *at != separator_) {
        throw InputError(place(),
                         "text after a closing quote; a quote inside a field is written twice");
      }
      fields.emplace_back(field, static_cast<size_t>(write - field));
    } else {
      const void* found = std::memchr(at, separator_, static_cast<size_t>(end - at));
      const char* stop = found ? static_cast<const char*>(found) : end;
      const std::string_view field(at, static_cast<size_t>(stop - at));
      if (field.find('"') != std::string_view::npos) {
        throw InputError(place(), "a quote inside a field that does not begin with one");
      }
      fields.push_back(field);
      at += field.size();
    }
    if (at == end) return;
    ++at;  // the separator
  }
}

bool CsvReader::next(std::vector<std::string_view>& fields) {
  for (;;) {
    record_line_ = next_line_;
    size_t length = 0;
    if (!find_record(length)) return false;
    char* begin = buffer_.data() + begin_;
    char* end = begin + length;
    begin_ += length;
    if (end > begin && end[-1] == '\n') --end;
    if (end > begin && end[-1] == '\r') --end;
    if (begin == end) continue;
    if (std::memchr(begin, '\0', static_cast<size_t>(end - begin))) {
      throw InputError(place(), "a zero byte; is this a text file?");
    }
    split(begin, end, fields);
    return true;
  }
}

}  // namespace pinchlab
