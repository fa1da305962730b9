// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/zip.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "base/partial_file.h"

namespace pinchlab::study {
namespace {

constexpr std::uint64_t largest = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t most_entries = 65535;
constexpr unsigned version = 20;        // of APPNOTE, for deflate
constexpr unsigned utf8_names = 0x800;  // general purpose flag
constexpr unsigned deflated = 8;        // method
constexpr unsigned new_year_1980 = (1U << 5U) | 1U;

// Little-endian numbers of `bytes` bytes.
std::string number(std::uint64_t value, unsigned bytes) {
  std::string text;
  for (unsigned i = 0; i < bytes; ++i) {
    text += static_cast<char>((value >> (8 * i)) & 0xFFU);
  }
  return text;
}

// Raw deflate, without zlib's head and tail.
std::string deflated_bytes(std::string_view bytes) {
  z_stream stream = {};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  // zlib does not write to its input, but its type says so.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int outcome = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (outcome != Z_STREAM_END) {
    throw std::runtime_error("deflate did not come to its end");
  }
  return packed;
}

// What the local and the central head have in common (4.4.2 to 4.4.11).
std::string common_head(const std::string& name, std::uint32_t crc, std::uint32_t packed_size,
                        std::uint32_t size) {
  return number(version, 2) + number(utf8_names, 2) + number(deflated, 2) + number(0, 2) +
         number(new_year_1980, 2) + number(crc, 4) + number(packed_size, 4) + number(size, 4) +
         number(name.size(), 2) + number(0, 2);
}

}  // namespace

ZipWriter::ZipWriter(std::filesystem::path path)
    : path_(std::move(path)),
      partial_(path_.string() + std::string(partial_ending)),
      file_(partial_, std::ios::binary | std::ios::trunc) {
  if (!file_) {
    throw std::runtime_error(
        fmt::format("{}: cannot be made: {}", path_.string(), std::strerror(errno)));
  }
}

ZipWriter::~ZipWriter() {
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void ZipWriter::write(std::string_view bytes) {
  written_ += bytes.size();
  if (written_ > largest) {
    throw std::runtime_error(path_.string() + ": would be larger than 4 GiB; show fewer clips");
  }
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file_) {
    throw std::runtime_error(
        fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
  }
}

void ZipWriter::add(const std::string& name, std::string_view bytes) {
  if (bytes.size() > largest || entries_.size() == most_entries) {
    throw std::runtime_error(path_.string() + ": too much for one archive; show fewer clips");
  }
  const std::string packed = deflated_bytes(bytes);
  const uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  const Entry entry = {
      name, static_cast<std::uint32_t>(crc), static_cast<std::uint32_t>(packed.size()),
      static_cast<std::uint32_t>(bytes.size()), static_cast<std::uint32_t>(written_)};
  write("PK\x03\x04" + common_head(name, entry.crc, entry.packed_size, entry.size) + name);
  write(packed);
  entries_.push_back(entry);
}

void ZipWriter::finish() {
  const std::uint64_t begin = written_;
  for (const Entry& entry : entries_) {
    write("PK\x01\x02" + number(version, 2) +
          common_head(entry.name, entry.crc, entry.packed_size, entry.size) + number(0, 2) +
          number(0, 2) + number(0, 2) + number(0, 4) + number(entry.offset, 4) + entry.name);
  }
  write("PK\x05\x06" + number(0, 4) + number(entries_.size(), 2) + number(entries_.size(), 2) +
        number(written_ - begin, 4) + number(begin, 4) + number(0, 2));
  file_.close();
  if (!file_) {
    throw std::runtime_error(
        fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
  }
  std::filesystem::rename(partial_, path_);
}

}  // namespace pinchlab::study
