// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// 256 colours for formats that have no more.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/pixel_rect.h"

namespace pinchlab {

/// The most frequent colours of a picture. A clip's pictures have few colours and blends of them at
/// edges, so that those of its first frame serve all.
class Palette {
 public:
  /// From RGBA pixels.
  Palette(const std::uint8_t* rgba, int width, int height);

  const std::array<std::uint32_t, 256>& argb() const { return argb_; }

  /// Writes the index of the nearest colour for each pixel of a part.
  void index(const std::uint8_t* rgba, int width, const PixelRect& part, std::uint8_t* to,
             std::ptrdiff_t stride);

 private:
  std::uint8_t nearest(int red, int green, int blue) const;

  std::array<std::uint32_t, 256> argb_{};
  std::vector<std::int16_t> known_;  // by 5 bits a channel; -1: not yet looked for
};

}  // namespace pinchlab
