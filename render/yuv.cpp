// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/yuv.h"

// The loops below are a tenth of a clip's cost: let the compiler also make a version for wider
// vectors. All versions give the same bytes.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PINCHLAB_WIDE __attribute__((target_clones("avx2", "default"), optimize("O3")))
#else
#define PINCHLAB_WIDE
#endif

namespace pinchlab {

namespace {

constexpr int bits = 16;

constexpr std::int32_t fixed_point(double value) {
  return static_cast<std::int32_t>(value * (1 << bits) + (value < 0.0 ? -0.5 : 0.5));
}

// ITU-R BT.709-6, items 3.2 to 3.4: Y' = Kr R + Kg G + Kb B, Cb = (B - Y') / 1.8556, Cr = (R - Y')
// / 1.5748; luma takes 16 to 235 and chroma 16 to 240 of 8 bits.
constexpr double kr = 0.2126, kg = 0.7152, kb = 0.0722;
constexpr double luma = 219.0 / 255.0, chroma_b = 224.0 / 255.0 / 1.8556,
                 chroma_r = 224.0 / 255.0 / 1.5748;
constexpr std::int32_t y_r = fixed_point(luma * kr), y_g = fixed_point(luma * kg),
                       y_b = fixed_point(luma * kb);
constexpr std::int32_t u_r = fixed_point(-chroma_b * kr), u_g = fixed_point(-chroma_b * kg),
                       u_b = fixed_point(chroma_b * (1.0 - kb));
constexpr std::int32_t v_r = fixed_point(chroma_r * (1.0 - kr)), v_g = fixed_point(-chroma_r * kg),
                       v_b = fixed_point(-chroma_r * kb);
constexpr std::int32_t y_offset = (16 << bits) + (1 << (bits - 1));
constexpr std::int32_t c_offset =
    (128 << (bits + 2)) + (1 << (bits + 1));  // of the sum of four pixels

std::uint8_t y_of(const std::uint8_t* p) {
  return static_cast<std::uint8_t>((y_r * p[0] + y_g * p[1] + y_b * p[2] + y_offset) >> bits);
}

}  // namespace

PINCHLAB_WIDE void rgba_to_yuv420(const std::uint8_t* rgba, int width, const PixelRect& part,
                                  const YuvPlanes& to) {
  const std::ptrdiff_t row = std::ptrdiff_t{width} * 4;
  for (int y = part.top; y < part.top + part.height; y += 2) {
    const std::uint8_t* const upper = rgba + y * row + std::ptrdiff_t{part.left} * 4;
    const std::uint8_t* const lower = upper + row;
    std::uint8_t* const y_upper = to.y + y * to.y_stride + part.left;
    std::uint8_t* const y_lower = y_upper + to.y_stride;
    std::uint8_t* const u = to.u + y / 2 * to.u_stride + part.left / 2;
    std::uint8_t* const v = to.v + y / 2 * to.v_stride + part.left / 2;
    for (std::ptrdiff_t x = 0; x < part.width; ++x) y_upper[x] = y_of(upper + 4 * x);
    for (std::ptrdiff_t x = 0; x < part.width; ++x) y_lower[x] = y_of(lower + 4 * x);
    for (std::ptrdiff_t x = 0; x < part.width / 2; ++x) {
      const std::uint8_t *a = upper + 8 * x, *b = lower + 8 * x;
      const std::int32_t red = a[0] + a[4] + b[0] + b[4];
      const std::int32_t green = a[1] + a[5] + b[1] + b[5];
      const std::int32_t blue = a[2] + a[6] + b[2] + b[6];
      u[x] = static_cast<std::uint8_t>((u_r * red + u_g * green + u_b * blue + c_offset) >>
                                       (bits + 2));
      v[x] = static_cast<std::uint8_t>((v_r * red + v_g * green + v_b * blue + c_offset) >>
                                       (bits + 2));
    }
  }
}

}  // namespace pinchlab
