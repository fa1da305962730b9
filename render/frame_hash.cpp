// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_hash.h"

extern "C" {
#include <libavutil/hash.h>
}

#include <array>
#include <new>

namespace pinchlab {

void FrameHash::Free::operator()(AVHashContext* context) const {
  av_hash_freep(&context);
}

FrameHash::FrameHash() {
  AVHashContext* context = nullptr;
  if (av_hash_alloc(&context, "murmur3") != 0) {
    throw std::bad_alloc();
  }
  context_.reset(context);
  av_hash_init(context);
}

void FrameHash::add(std::span<const std::byte> bytes) {
  av_hash_update(context_.get(), reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::string FrameHash::hex() {
  std::array<std::uint8_t, 2 * AV_HASH_MAX_SIZE + 1> digits{};
  av_hash_final_hex(context_.get(), digits.data(), digits.size());
  return reinterpret_cast<const char*>(digits.data());
}

}  // namespace pinchlab
