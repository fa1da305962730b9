// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pinchlab {

/// Pixels left .. left + width - 1 of rows top .. top + height - 1.
struct PixelRect {
  int left = 0, top = 0, width = 0, height = 0;
  bool operator==(const PixelRect&) const = default;
};

inline bool overlap(const PixelRect& a, const PixelRect& b) {
  return a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height &&
         b.top < a.top + a.height;
}

}  // namespace pinchlab
