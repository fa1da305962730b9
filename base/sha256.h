// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace pinchlab {

/// SHA-256 (FIPS 180-4, OpenSSL's) of bytes that come piece by piece.
class Sha256 {
 public:
  using Digest = std::array<unsigned char, 32>;

  Sha256();
  void add(std::span<const std::byte> bytes);
  void add(std::string_view bytes) { add(std::as_bytes(std::span(bytes))); }
  /// Nothing may be added afterwards.
  Digest digest();
  std::string hex();  ///< the digest as 64 lower-case hexadecimal digits

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

/// Of a text, as 64 lower-case hexadecimal digits.
std::string sha256(std::string_view bytes);

/// Of a whole file; InputError if it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace pinchlab
