// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/yuv.h"

#include <initializer_list>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace pinchlab {

namespace {

constexpr int bits = 15;  // so that a coefficient fits 16 bits

constexpr std::int32_t fixed_point(double value) {
  return static_cast<std::int32_t>(value * (1 << bits) + (value < 0.0 ? -0.5 : 0.5));
}

// ITU-R BT.709-6, items 3.2 to 3.4:
//     Y' = Kr R + Kg G + Kb B,   Cb = (B - Y') / 1.8556,   Cr = (R - Y') / 1.5748;
// luma takes 16 to 235 and chroma 16 to 240 of 8 bits.
constexpr double kr = 0.2126, kg = 0.7152, kb = 0.0722;
constexpr double luma = 219.0 / 255.0;
constexpr double chroma_b = 224.0 / 255.0 / 1.8556, chroma_r = 224.0 / 255.0 / 1.5748;

struct Weights {
  std::int32_t red, green, blue;
};
constexpr Weights y_of{fixed_point(luma * kr), fixed_point(luma* kg), fixed_point(luma* kb)};
constexpr Weights u_of{fixed_point(-chroma_b * kr), fixed_point(-chroma_b* kg),
                       fixed_point(chroma_b*(1.0 - kb))};
constexpr Weights v_of{fixed_point(chroma_r * (1.0 - kr)), fixed_point(-chroma_r* kg),
                       fixed_point(-chroma_r* kb)};
constexpr std::int32_t y_offset = (16 << bits) + (1 << (bits - 1));
constexpr int chroma_bits = bits + 2;  // the sum of four pixels
constexpr std::int32_t chroma_offset = (128 << chroma_bits) + (1 << (chroma_bits - 1));

std::uint8_t sample(const Weights& w, const std::int32_t* rgb, std::int32_t offset, int shift) {
  const std::int32_t sum = w.red * rgb[0] + w.green * rgb[1] + w.blue * rgb[2] + offset;
  return static_cast<std::uint8_t>(sum >> shift);
}

/// Two rows of RGBA and where their samples go.
struct RowPair {
  const std::uint8_t *upper, *lower;
  std::uint8_t *y_upper, *y_lower, *u, *v;
};

/// One 2 x 2 block.
void convert_block(const RowPair& rows, std::ptrdiff_t x) {
  std::int32_t sum[3] = {0, 0, 0};
  for (const bool below : {false, true}) {
    for (std::ptrdiff_t i = x; i < x + 2; ++i) {
      const std::uint8_t* from = (below ? rows.lower : rows.upper) + 4 * i;
      const std::int32_t pixel[3] = {from[0], from[1], from[2]};
      for (int c = 0; c < 3; ++c) sum[c] += pixel[c];
      (below ? rows.y_lower : rows.y_upper)[i] = sample(y_of, pixel, y_offset, bits);
    }
  }
  rows.u[x / 2] = sample(u_of, sum, chroma_offset, chroma_bits);
  rows.v[x / 2] = sample(v_of, sum, chroma_offset, chroma_bits);
}

#if defined(__SSE2__)
// The same for 16 x 2 pixels at a time, with the same bytes: compilers do not find the way by
// themselves, and without it the conversion would be a tenth of a clip's cost.

/// Four pixels as pairs of 16 bits: red and blue, green and nothing.
struct Four {
  __m128i red_blue, green;
};

Four load(const std::uint8_t* rgba) {
  const __m128i pixels = _mm_loadu_si128(reinterpret_cast<const __m128i*>(rgba));
  const __m128i mask = _mm_set1_epi32(0x00ff00ff);
  return {_mm_and_si128(pixels, mask),
          _mm_and_si128(_mm_srli_epi32(pixels, 8), _mm_set1_epi32(0xff))};
}

__m128i samples(const Four& p, const Weights& w, std::int32_t offset, int shift) {
  const __m128i red_blue = _mm_set1_epi32(w.blue << 16 | (w.red & 0xffff));
  const __m128i green = _mm_set1_epi32(w.green & 0xffff);
  const __m128i sum =
      _mm_add_epi32(_mm_madd_epi16(p.red_blue, red_blue), _mm_madd_epi16(p.green, green));
  return _mm_srai_epi32(_mm_add_epi32(sum, _mm_set1_epi32(offset)), shift);
}

/// The sums of 2 x 2 blocks of eight pixels in two rows.
Four block_sums(const Four& a, const Four& b, const Four& below_a, const Four& below_b) {
  const auto pairs = [](__m128i left, __m128i right) {
    left = _mm_add_epi16(left, _mm_srli_epi64(left, 32));
    right = _mm_add_epi16(right, _mm_srli_epi64(right, 32));
    return _mm_castps_si128(
        _mm_shuffle_ps(_mm_castsi128_ps(left), _mm_castsi128_ps(right), _MM_SHUFFLE(2, 0, 2, 0)));
  };
  return {pairs(_mm_add_epi16(a.red_blue, below_a.red_blue),
                _mm_add_epi16(b.red_blue, below_b.red_blue)),
          pairs(_mm_add_epi16(a.green, below_a.green), _mm_add_epi16(b.green, below_b.green))};
}

void convert_16(const RowPair& rows, std::ptrdiff_t x) {
  Four upper[4], lower[4];
  __m128i y[2][4];
  for (std::ptrdiff_t i = 0; i < 4; ++i) {
    upper[i] = load(rows.upper + 4 * (x + 4 * i));
    lower[i] = load(rows.lower + 4 * (x + 4 * i));
    y[0][i] = samples(upper[i], y_of, y_offset, bits);
    y[1][i] = samples(lower[i], y_of, y_offset, bits);
  }
  for (int row = 0; row < 2; ++row) {
    const __m128i all = _mm_packus_epi16(_mm_packs_epi32(y[row][0], y[row][1]),
                                         _mm_packs_epi32(y[row][2], y[row][3]));
    _mm_storeu_si128(reinterpret_cast<__m128i*>((row == 0 ? rows.y_upper : rows.y_lower) + x), all);
  }
  const Four left = block_sums(upper[0], upper[1], lower[0], lower[1]);
  const Four right = block_sums(upper[2], upper[3], lower[2], lower[3]);
  for (const bool is_v : {false, true}) {
    const Weights& w = is_v ? v_of : u_of;
    const __m128i eight = _mm_packs_epi32(samples(left, w, chroma_offset, chroma_bits),
                                          samples(right, w, chroma_offset, chroma_bits));
    _mm_storel_epi64(reinterpret_cast<__m128i*>((is_v ? rows.v : rows.u) + x / 2),
                     _mm_packus_epi16(eight, eight));
  }
}
#endif

}  // namespace

void rgba_to_yuv420(const std::uint8_t* rgba, int width, const PixelRect& part,
                    const YuvPlanes& to) {
  const std::ptrdiff_t row = std::ptrdiff_t{width} * 4;
  for (std::ptrdiff_t y = part.top; y < part.top + part.height; y += 2) {
    const RowPair rows{rgba + y * row,
                       rgba + (y + 1) * row,
                       to.y + y * to.y_stride,
                       to.y + (y + 1) * to.y_stride,
                       to.u + y / 2 * to.u_stride,
                       to.v + y / 2 * to.v_stride};
    std::ptrdiff_t x = part.left;
    const std::ptrdiff_t end = x + part.width;
#if defined(__SSE2__)
    for (; x + 16 <= end; x += 16) convert_16(rows, x);
#endif
    for (; x < end; x += 2) convert_block(rows, x);
  }
}

}  // namespace pinchlab
