// SPDX-License-Identifier: GPL-3.0-or-later
// What the tile painter does better than a driver: no pixel is missed, mixing rounds once, and the
// bytes are the same everywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "render/canvas.h"

namespace pinchlab {
namespace {

constexpr int size = 96;  // px, and the view's sides in metres
constexpr Colour ink{0, 0, 0, 255}, orange{236, 165, 46, 255}, brown{110, 62, 8, 255};

Picture page() {
  Picture picture;
  picture.view = {{0.0, 0.0}, {size, size}};
  picture.background = {255, 255, 255, 255};
  return picture;
}

/// Numbers from 0 to 1 that look random: a linear congruential generator (Knuth's MMIX).
class Numbers {
 public:
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * next(); }

 private:
  std::uint64_t state_ = 1;
};

Vec2 unit_vector(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

// A line, an arc and a line again, translucent: a pixel missed or drawn twice stands out.
TEST(Tiles, NoPixelIsMissedOrDrawnTwiceWherePiecesMeet) {
  Numbers numbers;
  Canvas canvas(size, size);
  for (int trial = 0; trial < 300; ++trial) {
    Picture picture = page();
    const Vec2 centre(numbers.between(40.0, 56.0), numbers.between(40.0, 56.0));
    const double radius = numbers.between(12.0, 25.0), half = numbers.between(3.0, 9.0);
    const double from = numbers.between(0.0, 6.0), sweep = numbers.between(0.3, 3.0);
    const int pieces = static_cast<int>(std::ceil(sweep / (0.4 * numbers.between(0.1, 1.0))));
    const double straight = 15.0;
    const auto add = [&](double angle, double ahead) {
      const Vec2 e = unit_vector(angle), along(-e.y(), e.x());
      picture.points.push_back({centre + radius * e + ahead * along, along, 0.0});
    };
    add(from, -straight);
    for (int k = 0; k <= pieces; ++k) add(from + sweep * k / pieces, 0.0);
    add(from + sweep, straight);
    picture.add(Strip{0, picture.points.size(), half, 0.0, 1.0, 0.0, {0, 0, 0, 128}, {}, {}});
    const std::uint8_t* pixels = canvas.draw(picture);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const Vec2 p = Vec2(x + 0.5, size - y - 0.5) - centre;
        const double angle =
            std::remainder(std::atan2(p.y(), p.x()) - from, 2.0 * std::numbers::pi);
        const bool on_arc = angle > -0.1 && angle < sweep;
        if (!on_arc || std::abs(p.norm() - radius) > half - 1.0) continue;
        ASSERT_EQ(pixels[4 * (y * size + x)], 127) << trial << ": " << x << " " << y;
      }
    }
  }
}

// However many translucent shapes lie on one another: each level within one half of the exact one,
// and a little for single precision.
TEST(Tiles, MixingRoundsOnce) {
  Numbers numbers;
  Canvas canvas(size, size);
  for (int trial = 0; trial < 100; ++trial) {
    Picture picture = page();
    double exact = 255.0;
    for (int k = 0; k < 12; ++k) {
      const auto level = static_cast<std::uint8_t>(numbers.between(0.0, 256.0));
      const auto alpha = static_cast<std::uint8_t>(numbers.between(0.0, 256.0));
      const Colour colour{level, level, level, alpha};
      picture.add(Stroke{{48.0, 48.0}, {48.0, 48.0}, 40.0, 0.0, colour, {0, 0, 0, 0}});
      exact += alpha / 255.0 * (level - exact);
    }
    const std::uint8_t* pixels = canvas.draw(picture);
    EXPECT_NEAR(pixels[4 * (48 * size + 48)], exact, 0.501) << trial;
    // A pixel of a tile in which the rim is seen is like one of a tile within the disc.
    EXPECT_EQ(pixels[4 * (48 * size + 86)], pixels[4 * (48 * size + 48)]) << trial;
  }
}

// Only operations that IEEE 754 fixes to the last digit: no processor, compiler or driver shows in
// the frames. If a change of the drawing is meant, put the printed value here and tag it in
// CHANGELOG.md.
TEST(Tiles, TheBytesAreTheSameOnEveryMachine) {
  Picture picture = page();
  picture.corners = {{10.5, 60.5}, {40.5, 70.5}, {30.5, 90.5}};
  picture.add(Patch{0, 3, {0, 90, 160, 128}});
  for (int k = 0; k < 9; ++k) {
    const Vec2 e = unit_vector(0.35 * k), along(-e.y(), e.x());
    picture.points.push_back({Vec2(48.3, 40.2) + 30.7 * e, along, 10.745 * k});
  }
  picture.add(Strip{0, picture.points.size(), 6.3, 1.2, 14.0, 4.0, orange, brown, ink});
  picture.add(
      Stroke{{40.2, 44.4}, {40.2, 44.4}, 25.3, 2.2, {172, 206, 236, 128}, {0, 82, 130, 255}});
  picture.add(Stroke{{10.2, 12.4}, {80.9, 31.6}, 0.4, 0.0, ink, {0, 0, 0, 0}});
  picture.add(Stroke{{20.2, 80.4}, {80.9, 51.6}, 3.4, 0.7, orange, ink});
  Canvas canvas(size, size);
  const std::uint8_t* pixels = canvas.draw(picture);
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (int i = 0; i < 4 * size * size; ++i) hash = (hash ^ pixels[i]) * 1099511628211u;
  EXPECT_EQ(hash, 0x60311f08a77a3a28u) << std::hex << "0x" << hash;
}

}  // namespace
}  // namespace pinchlab
