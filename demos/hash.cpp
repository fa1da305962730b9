// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/hash.h"

extern "C" {
#include <libavutil/hash.h>
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

void Hash::Free::operator()(AVHashContext* context) const {
  av_hash_freep(&context);
}

Hash::Hash(HashKind kind) {
  AVHashContext* context = nullptr;
  if (av_hash_alloc(&context, kind == HashKind::sha256 ? "SHA256" : "murmur3") != 0) {
    throw std::bad_alloc();
  }
  context_.reset(context);
  av_hash_init(context);
}

void Hash::add(std::span<const std::byte> bytes) {
  av_hash_update(context_.get(), reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::string Hash::hex() {
  std::array<std::uint8_t, 2 * AV_HASH_MAX_SIZE + 1> digits{};
  av_hash_final_hex(context_.get(), digits.data(), digits.size());
  return reinterpret_cast<const char*>(digits.data());
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const auto fail = [&] {
    throw std::runtime_error(
        fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (!file) {
    fail();
  }
  Hash sha(HashKind::sha256);
  std::vector<std::byte> buffer(1U << 16U);
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    sha.add(std::span(buffer).first(got));
  }
  if (std::ferror(file.get()) != 0) {
    fail();
  }
  return sha.hex();
}

}  // namespace pinchlab
