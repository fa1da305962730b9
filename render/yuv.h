// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Colour conversion for 4:2:0 video.

#include <cstddef>
#include <cstdint>

#include "render/pixel_rect.h"

namespace pinchlab {

/// The planes of a 4:2:0 frame and the bytes from one row to the next.
struct YuvPlanes {
  std::uint8_t *y, *u, *v;
  std::ptrdiff_t y_stride, u_stride, v_stride;
};

/// RGBA (8 bits each, top row first, `width` * 4 bytes a row) to Y'CbCr of ITU-R BT.709, limited
/// range, each chroma sample the mean of its 2 x 2 pixels (sited at their centre); only within
/// `part`, whose sides and place are even. Every sample is within 0.52 of the exact value before
/// rounding.
void rgba_to_yuv420(const std::uint8_t* rgba, int width, const PixelRect& part,
                    const YuvPlanes& to);

}  // namespace pinchlab
