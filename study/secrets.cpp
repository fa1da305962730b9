// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/secrets.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

extern "C" {
#include <libavutil/mem.h>
#include <libavutil/sha.h>
}

namespace pinchlab::study {
namespace {

constexpr std::string_view base32 =
    "0123456789ABCDEFGHJKMNPQRSTVWXYZ";  // Crockford's: no I, L, O, U
constexpr std::size_t code_length = 12;

std::array<unsigned char, 32> digest(std::string_view bytes) {
  const std::unique_ptr<AVSHA, void (*)(void*)> sha(av_sha_alloc(), &av_free);
  if (!sha || av_sha_init(sha.get(), 256) != 0) {
    throw std::bad_alloc();
  }
  av_sha_update(sha.get(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  std::array<unsigned char, 32> result{};
  av_sha_final(sha.get(), result.data());
  return result;
}

}  // namespace

std::string random_hex(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  std::size_t have = 0;
  while (have < bytes) {
    const ssize_t got = ::getrandom(random.data() + have, bytes - have, 0);
    if (got < 0 && errno != EINTR) {
      throw std::runtime_error("the system gives no random numbers");
    }
    have += got > 0 ? static_cast<std::size_t>(got) : 0;
  }
  return fmt::format("{:02x}", fmt::join(random, ""));
}

std::string sha256(std::string_view bytes) {
  return fmt::format("{:02x}", fmt::join(digest(bytes), ""));
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) {
    return false;
  }
  volatile unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  }
  return difference == 0;
}

std::string withdrawal_code(std::string_view secret) {
  const auto bytes = digest("withdrawal " + std::string(secret));
  std::string code;
  for (std::size_t i = 0; i < code_length; ++i) {
    if (i > 0 && i % 4 == 0) {
      code += '-';
    }
    code += base32[bytes[i] % base32.size()];
  }
  return code;
}

std::string withdrawal_hash(std::string_view typed_code) {
  std::string code;
  for (const char typed : typed_code) {
    const char c = 'a' <= typed && typed <= 'z' ? static_cast<char>(typed - 'a' + 'A') : typed;
    if (c == '-' || c == ' ') {
      continue;
    }
    code += c == 'O' ? '0' : c == 'I' || c == 'L' ? '1' : c;
  }
  const bool is_code =
      code.size() == code_length && code.find_first_not_of(base32) == std::string::npos;
  return is_code ? sha256("code " + code) : "";
}

}  // namespace pinchlab::study
