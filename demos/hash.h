// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

struct AVHashContext;

namespace pinchlab {

enum class HashKind {
  sha256,   ///< proves that files are the same; 7 ms a frame of 960 x 960
  murmur3,  ///< 128 bits; tells that frames differ, 0.4 ms a frame
};

/// A hash of bytes that come piece by piece (libavutil's).
class Hash {
 public:
  explicit Hash(HashKind kind);
  void add(std::span<const std::byte> bytes);
  /// Lower-case hexadecimal digits. Nothing may be added afterwards.
  std::string hex();

 private:
  struct Free {
    void operator()(AVHashContext* context) const;
  };
  std::unique_ptr<AVHashContext, Free> context_;
};

/// SHA-256 of a whole file; std::runtime_error if it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace pinchlab
