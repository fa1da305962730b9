// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

struct AVHashContext;

namespace pinchlab {

/// MurmurHash3 (128 bits, libavutil's) of frames that come one after the other: tells that frames
/// differ, in a twentieth of the time that SHA-256 takes. Proves nothing to an adversary.
class FrameHash {
 public:
  FrameHash();
  void add(std::span<const std::byte> bytes);
  /// Lower-case hexadecimal digits. Nothing may be added afterwards.
  std::string hex();

 private:
  struct Free {
    void operator()(AVHashContext* context) const;
  };
  std::unique_ptr<AVHashContext, Free> context_;
};

}  // namespace pinchlab
