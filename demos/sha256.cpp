// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/sha256.h"

extern "C" {
#include <libavutil/mem.h>
#include <libavutil/sha.h>
}
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>
#include <vector>

namespace pinchlab {

void Sha256::Free::operator()(AVSHA* context) const {
  av_free(context);
}

Sha256::Sha256() : context_(av_sha_alloc()) {
  if (!context_ || av_sha_init(context_.get(), 256) != 0) {
    throw std::bad_alloc();
  }
}

void Sha256::add(std::span<const std::byte> bytes) {
  av_sha_update(context_.get(), reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::string Sha256::hex() {
  std::array<std::uint8_t, 32> digest{};
  av_sha_final(context_.get(), digest.data());
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (!file) {
    throw std::runtime_error(
        fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
  }
  Sha256 sha;
  std::vector<std::byte> buffer(1U << 16U);
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    sha.add(std::span(buffer).first(got));
  }
  if (std::ferror(file.get()) != 0) {
    throw std::runtime_error(
        fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
  }
  return sha.hex();
}

}  // namespace pinchlab
