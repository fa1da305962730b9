// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

struct AVSHA;

namespace pinchlab {

/// SHA-256 of bytes that come piece by piece (libavutil's).
class Sha256 {
 public:
  Sha256();
  void add(std::span<const std::byte> bytes);
  /// 64 hexadecimal digits. Nothing may be added afterwards.
  std::string hex();

 private:
  struct Free {
    void operator()(AVSHA* context) const;
  };
  std::unique_ptr<AVSHA, Free> context_;
};

/// SHA-256 of a whole file; std::runtime_error if it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace pinchlab
