// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/secrets.h"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <stdexcept>
#include <vector>

#include "base/sha256.h"

namespace pinchlab::study {
namespace {

constexpr std::string_view base32 =
    "0123456789ABCDEFGHJKMNPQRSTVWXYZ";  // Crockford's: no I, L, O, U
constexpr std::size_t code_length = 12;

}  // namespace

std::string random_hex(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  if (RAND_bytes(random.data(), static_cast<int>(bytes)) != 1) {
    throw std::runtime_error("the system gives no random numbers");
  }
  return fmt::format("{:02x}", fmt::join(random, ""));
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string withdrawal_code(std::string_view secret) {
  Sha256 sha;
  sha.add("withdrawal ");
  sha.add(secret);
  const Sha256::Digest bytes = sha.digest();
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
