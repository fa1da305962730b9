// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sha256.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <new>
#include <stdexcept>

#include "base/read_file.h"

namespace pinchlab {
namespace {

void check(int result) {
  if (result != 1) {
    throw std::runtime_error("libcrypto cannot compute SHA-256");
  }
}

}  // namespace

void Sha256::Free::operator()(evp_md_ctx_st* context) const {
  EVP_MD_CTX_free(context);
}

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  if (!context_) {
    throw std::bad_alloc();
  }
  check(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
}

void Sha256::add(std::span<const std::byte> bytes) {
  check(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()));
}

Sha256::Digest Sha256::digest() {
  Digest digest{};
  check(EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr));
  return digest;
}

std::string Sha256::hex() {
  return fmt::format("{:02x}", fmt::join(digest(), ""));
}

std::string sha256(std::string_view bytes) {
  Sha256 sha;
  sha.add(bytes);
  return sha.hex();
}

std::string sha256_of_file(const std::filesystem::path& path) {
  Sha256 sha;
  read_by_pieces(path, [&sha](std::string_view piece) { sha.add(piece); });
  return sha.hex();
}

}  // namespace pinchlab
