// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/palette.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace pinchlab {

namespace {

constexpr std::size_t cells = std::size_t{32} * 32 * 32;

std::size_t cell_of(const std::uint8_t* rgba) {
  return static_cast<std::size_t>(rgba[0] >> 3 << 10 | rgba[1] >> 3 << 5 | rgba[2] >> 3);
}

}  // namespace

Palette::Palette(const std::uint8_t* rgba, int width, int height) : known_(cells, -1) {
  struct Cell {
    std::int64_t count = 0, red = 0, green = 0, blue = 0;
  };
  std::vector<Cell> seen(cells);
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < count; ++i, rgba += 4) {
    Cell& cell = seen[cell_of(rgba)];
    ++cell.count;
    cell.red += rgba[0];
    cell.green += rgba[1];
    cell.blue += rgba[2];
  }
  std::vector<std::size_t> order(cells);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](std::size_t i) { return seen[i].count; });
  for (std::size_t i = 0; i < argb_.size(); ++i) {
    const Cell& cell = seen[order[i]];
    const std::int64_t n = std::max<std::int64_t>(1, cell.count);
    argb_[i] = static_cast<std::uint32_t>(0xff000000 | cell.red / n << 16 | cell.green / n << 8 |
                                          cell.blue / n);
  }
}

std::uint8_t Palette::nearest(int red, int green, int blue) const {
  int least = std::numeric_limits<int>::max();
  std::size_t found = 0;
  for (std::size_t i = 0; i < argb_.size(); ++i) {
    const auto part = [&](int shift) { return static_cast<int>(argb_[i] >> shift & 0xff); };
    const int r = red - part(16), g = green - part(8), b = blue - part(0);
    const int distance = 2 * r * r + 4 * g * g + 3 * b * b;  // as the eye weighs them, roughly
    if (distance < least) {
      least = distance;
      found = i;
    }
  }
  return static_cast<std::uint8_t>(found);
}

void Palette::index(const std::uint8_t* rgba, int width, const PixelRect& part, std::uint8_t* to,
                    std::ptrdiff_t stride) {
  for (int y = part.top; y < part.top + part.height; ++y) {
    const std::uint8_t* from = rgba + (std::ptrdiff_t{y} * width + part.left) * 4;
    std::uint8_t* out = to + y * stride + part.left;
    for (int x = 0; x < part.width; ++x, from += 4) {
      std::int16_t& known = known_[cell_of(from)];
      if (known < 0) known = nearest(from[0], from[1], from[2]);
      *out++ = static_cast<std::uint8_t>(known);
    }
  }
}

}  // namespace pinchlab
