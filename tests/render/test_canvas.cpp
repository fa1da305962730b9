// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "render/canvas.h"
#include "render/picture/compose.h"
#include "tests/base/message_of.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

constexpr int size = 96;  // px, and m: one metre is one pixel here
constexpr Colour white{255, 255, 255}, ink{0, 90, 140}, orange{236, 165, 46}, brown{110, 62, 8};

/// What covers a point (px from the top left): index into a list of colours, -1 for the background.
using Shape = std::function<int(double x, double y)>;

/// RMS difference, in levels, between a canvas' pixels and the means of 16 x 16 samples each.
double rms_error(const std::uint8_t* drawn, const Shape& shape,
                 const std::vector<Colour>& colours) {
  constexpr int samples = 16;
  double sum = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      std::array<double, 3> mean{};
      for (int i = 0; i < samples * samples; ++i) {
        const int hit = shape(x + (i % samples + 0.5) / samples, y + (i / samples + 0.5) / samples);
        const Colour c = hit < 0 ? white : colours[static_cast<std::size_t>(hit)];
        mean[0] += c.red;
        mean[1] += c.green;
        mean[2] += c.blue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const double d =
            mean[k] / (samples * samples) - drawn[(y * size + x) * 4 + static_cast<int>(k)];
        sum += d * d;
      }
    }
  }
  return std::sqrt(sum / (3.0 * size * size));
}

Picture page() {
  Picture picture;
  picture.view = {{0.0, 0.0}, {size, size}};
  picture.background = white;
  return picture;
}

double distance_to_line(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double t =
      d.squaredNorm() > 0.0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

// Bound: at an edge a box 1 px wide across it, which the shaders use, differs from the pixel's
// square by at most 0.043 of the contrast, and by 0.025 in the RMS over the pixels within 1 px of
// it, both at 45 degrees (at 0 degrees not at all). For edges of total length e px and contrast c
// that makes 0.025 c sqrt(2 e / 96^2).
double bound(double edge_length, double contrast) {
  return 0.025 * contrast * std::sqrt(2.0 * edge_length / (size * size));
}

TEST(Canvas, DiscWithRimMatchesSupersampling) {
  Picture picture = page();
  const Vec2 centre(47.3, 50.8);
  picture.add(Stroke{centre, centre, 30.4, 4.0, orange, ink});
  Canvas canvas(size, size);
  const Shape shape = [&](double x, double y) {
    const double d = (Vec2(x, size - y) - centre).norm();
    return d > 30.4 ? -1 : d > 26.4 ? 1 : 0;
  };
  const double edges = 2.0 * std::numbers::pi * (30.4 + 26.4);
  EXPECT_LT(rms_error(canvas.draw(picture), shape, {orange, ink}), bound(edges, 255.0));
}

TEST(Canvas, CapsulesMatchSupersamplingEvenBelowAPixel) {
  for (const double half : {6.3, 1.0, 0.3}) {
    Picture picture = page();
    const Vec2 a(20.2, 30.7), b(70.9, 61.4);
    picture.add(Stroke{a, b, half, 0.0, ink, ink});
    Canvas canvas(size, size);
    const Shape shape = [&](double x, double y) {
      return distance_to_line(Vec2(x, size - y), a, b) > half ? -1 : 0;
    };
    const double edges = 2.0 * (b - a).norm() + 2.0 * std::numbers::pi * half;
    EXPECT_LT(rms_error(canvas.draw(picture), shape, {ink}), bound(edges, 255.0)) << half;
  }
}

// Each pixel whose middle is inside, once, translucent or not.
TEST(Canvas, PatchesFillTheirPolygon) {
  Picture picture = page();
  picture.corners = {{20.5, 20.5}, {70.5, 30.5}, {80.5, 70.5}, {40.5, 80.5}, {15.5, 50.5}};
  Colour half = ink;
  half.alpha = 128;
  picture.add(Patch{0, 5, half});
  Canvas canvas(size, size);
  const std::uint8_t* pixels = canvas.draw(picture);
  const auto at = [&](int x, int y) { return pixels[4 * ((size - 1 - y) * size + x)]; };
  const std::uint8_t paper = at(2, 2), inside = at(50, 50);
  EXPECT_NE(inside, paper);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      double least = 1e9;  // px, inside of the nearest side
      for (std::size_t k = 0; k < 5; ++k) {
        const Vec2 &a = picture.corners[k], &b = picture.corners[(k + 1) % 5];
        const Vec2 d = (b - a).normalized(), p = Vec2(x + 0.5, y + 0.5) - a;
        least = std::min(least, d.x() * p.y() - d.y() * p.x());
      }
      if (std::abs(least) < 1e-3) continue;
      ASSERT_EQ(at(x, y), least > 0.0 ? inside : paper) << x << " " << y;
    }
  }
}

TEST(Canvas, ArcsOfAStripAreRoundAndCarryTheirMarks) {
  // Half a turn of radius 30 in pieces of the largest allowed turn.
  const Vec2 centre(48.2,
                    40.0);  // the flat ends, which are not smoothed, lie between rows of pixels
  const double radius = 30.0, half = 5.5, spacing = 12.0, mark = 4.0;
  Picture picture = page();
  const int pieces = static_cast<int>(std::ceil(std::numbers::pi / most_turn));
  for (int k = 0; k <= pieces; ++k) {
    const double a = std::numbers::pi * k / pieces;
    picture.points.push_back({centre + radius * Vec2(std::cos(a), std::sin(a)),
                              {-std::sin(a), std::cos(a)},
                              3.0 + radius * a});
  }
  picture.add(Strip{0, picture.points.size(), half, 1.5, spacing, mark, orange, ink, brown});
  Canvas canvas(size, size);
  const Shape shape = [&](double x, double y) {
    const Vec2 p = Vec2(x, size - y) - centre;
    const double t = std::abs(p.norm() - radius), a = std::atan2(p.y(), p.x());
    if (t > half || a < 0.0) return -1;
    if (t > half - 1.5) return 1;
    const double m = 3.0 + radius * a, from_mark = m - spacing * std::round(m / spacing);
    return std::abs(from_mark) < 0.5 * mark ? 2 : 0;
  };
  // Four long edges, and eight marks with two edges each.
  const double edges = 4.0 * std::numbers::pi * radius + 16.0 * 2.0 * half;
  EXPECT_LT(rms_error(canvas.draw(picture), shape, {orange, ink, brown}), bound(edges, 255.0));
}

TEST(Canvas, PiecesOfAStripLeaveNeitherGapsNorSeams) {
  // A wave of many short pieces over its own colour: any pixel missed or drawn twice would stand
  // out.
  Picture picture = page();
  const double half = 8.0;
  for (int k = 0; k <= 200; ++k) {
    const double x = 8.0 + 0.4 * k;
    picture.points.push_back({{x, 48.0 + 6.0 * std::sin(0.15 * x)},
                              Vec2(1.0, 0.9 * std::cos(0.15 * x)).normalized(),
                              x});
  }
  picture.add(Strip{0, picture.points.size(), half, 0.0, 1.0, 0.0, {0, 0, 0, 128}, {}, {}});
  Canvas canvas(size, size);
  const std::uint8_t* pixels = canvas.draw(picture);
  for (int x = 12; x < 84; ++x) {
    const int y = static_cast<int>(size - (48.0 + 6.0 * std::sin(0.15 * x)));
    for (int dy = -4; dy <= 4; ++dy)
      EXPECT_NEAR(pixels[((y + dy) * size + x) * 4], 127, 1) << x << " " << dy;
  }
}

TEST(Canvas, KinksHaveRoundJoints) {
  // Right, then up, then back down at a slant: turns of 90 and 153 degrees in steps of most_turn.
  const std::array<Vec2, 4> corners = {Vec2(20.0, 30.0), Vec2(60.0, 30.0), Vec2(60.0, 70.0),
                                       Vec2(40.0, 30.0)};
  const double half = 6.3;
  Picture picture = page();
  const auto direction = [&](std::size_t i) {
    return Vec2((corners[i + 1] - corners[i]).normalized());
  };
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    if (i > 0) {
      const Vec2 before = direction(i - 1);
      const double turn = std::acos(before.dot(direction(i)));
      const int pieces = static_cast<int>(std::ceil(turn / most_turn));
      for (int k = 1; k < pieces; ++k) {
        const double a = turn * k / pieces;
        picture.points.push_back(
            {corners[i], std::cos(a) * before + std::sin(a) * Vec2(-before.y(), before.x()), 0.0});
      }
    }
    picture.points.push_back({corners[i], direction(i), 0.0});
    picture.points.push_back({corners[i + 1], direction(i), 0.0});
  }
  picture.add(Strip{0, picture.points.size(), half, 0.0, 1.0, 0.0, ink, {}, {}});
  Canvas canvas(size, size);
  const Shape shape = [&](double x, double y) {
    const Vec2 p(x, size - y);
    double nearest = infinity;
    for (std::size_t i = 0; i < 3; ++i)
      nearest = std::min(nearest, distance_to_line(p, corners[i], corners[i + 1]));
    // The two ends are flat.
    const bool before =
        p.x()<20.0, after = (p - corners[3]).dot(direction(2))> 0.0 && p.y() < 30.0 - half;
    return nearest > half || before || after ? -1 : 0;
  };
  EXPECT_LT(rms_error(canvas.draw(picture), shape, {ink}),
            bound(2.0 * 125.0 + 2.0 * std::numbers::pi * half, 255.0));
}

TEST(Canvas, LaterShapesLieOnTopAndAlphaMixes) {
  Picture picture = page();
  picture.add(Stroke{{48.0, 48.0}, {48.0, 48.0}, 20.0, 0.0, {200, 0, 0}, {}});
  picture.add(Stroke{{48.0, 48.0}, {48.0, 48.0}, 20.0, 0.0, {0, 0, 100, 128}, {}});
  Canvas canvas(size, size);
  const std::uint8_t* middle = canvas.draw(picture) + (48 * size + 48) * 4;
  EXPECT_NEAR(middle[0], 100, 1);
  EXPECT_NEAR(middle[2], 50, 1);
  EXPECT_EQ(middle[3], 255);
}

TEST(Canvas, FirstRowIsTheTop) {
  Picture picture = page();
  picture.add(Stroke{{20.0, 80.0}, {20.0, 80.0}, 5.0, 0.0, ink, ink});  // left, near the top
  Canvas canvas(size, size);
  const std::uint8_t* pixels = canvas.draw(picture);
  EXPECT_EQ(pixels[(16 * size + 20) * 4], ink.red);
  EXPECT_EQ(pixels[(80 * size + 20) * 4], white.red);
}

TEST(Canvas, FitsTheViewWithoutStretchingIt) {
  Picture picture = page();
  picture.view = {{-1.0, -1.0}, {1.0, 1.0}};
  picture.add(Stroke{{0.0, 0.0}, {0.0, 0.0}, 1.0, 0.0, ink, ink});
  Canvas canvas(200, 100);
  const std::uint8_t* pixels = canvas.draw(picture);
  const auto red = [&](int x, int y) { return pixels[(y * 200 + x) * 4]; };
  EXPECT_EQ(red(52, 50), ink.red);  // 48 px left of the middle, inside the disc of 50 px
  EXPECT_EQ(red(47, 50), white.red);
  EXPECT_EQ(red(100, 2), ink.red);
}

std::vector<std::uint8_t> copy(const std::uint8_t* pixels, int width, int height) {
  return {pixels, pixels + static_cast<std::ptrdiff_t>(width) * height * 4};
}

TEST(Canvas, SamePictureSameBytesInAnyCanvas) {
  const Scene scene = testing::atwood();
  Picture picture;
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), picture);
  Canvas first(240, 200), second(240, 200);
  const auto a = copy(first.draw(picture), 240, 200);
  second.draw(page());
  EXPECT_EQ(a, copy(second.draw(picture), 240, 200));
  EXPECT_EQ(a, copy(first.draw(picture), 240, 200));
}

TEST(Canvas, ReadsBackEverythingThatChanges) {
  // A canvas that has drawn the frames before must agree with a fresh one, and say where they
  // differ.
  const Scene scene = testing::atwood();
  World world = make_world(scene, Method::pinch);
  Canvas canvas(160, 160);
  Picture picture;
  std::vector<std::uint8_t> last;
  const Scenery scenery = set_scenery(scene);
  for (int frame = 0; frame < 12; ++frame) {
    compose(scene, scenery, world, picture);
    if (frame == 5) picture.labels[0].text = "other";
    const auto pixels = copy(canvas.draw(picture), 160, 160);
    Canvas fresh(160, 160);
    ASSERT_EQ(pixels, copy(fresh.draw(picture), 160, 160)) << frame;
    if (frame > 0) {
      std::vector<std::uint8_t> patched = last;
      for (const PixelRect& r : canvas.changed()) {
        EXPECT_EQ((r.left | r.top | r.width | r.height) % 2, 0);
        for (int y = r.top; y < r.top + r.height; ++y) {
          const auto at = static_cast<std::ptrdiff_t>(y * 160 + r.left) * 4;
          std::copy_n(pixels.begin() + at, r.width * 4, patched.begin() + at);
        }
      }
      EXPECT_EQ(patched, pixels) << frame;
    }
    last = pixels;
    world.angle[0] += 0.3;
    world.position[1].y() -= 0.05;
  }
  canvas.draw(picture);
  EXPECT_TRUE(canvas.changed().empty());
}

int area_of(const std::vector<PixelRect>& parts) {
  int sum = 0;
  for (const PixelRect& r : parts) sum += r.width * r.height;
  return sum;
}

TEST(Canvas, DrawsOnlyWhereMarksOfARunningCableAre) {
  // Straight on, then half a turn; one mark every 150 px.
  constexpr int side = 512;
  const auto rope = [&](double run) {
    Picture picture;
    picture.view = {{0.0, 0.0}, {side, side}};
    picture.points.push_back({{300.0, 40.0}, {-1.0, 0.0}, run});
    for (int k = 0; k <= 8; ++k) {
      const double a = std::numbers::pi * (1.5 - k / 8.0);
      picture.points.push_back({Vec2(200.0, 240.0) + 200.0 * Vec2(std::cos(a), std::sin(a)),
                                Vec2(std::sin(a), -std::cos(a)),
                                run + 100.0 + 200.0 * std::numbers::pi * k / 8.0});
    }
    picture.add(Strip{0, picture.points.size(), 20.0, 3.0, 150.0, 40.0, orange, ink, brown});
    return picture;
  };
  Canvas canvas(side, side);
  canvas.draw(rope(0.0));
  for (const double run : {3.0, 5.0, 44.0, 130.0}) {
    const auto pixels = copy(canvas.draw(rope(run)), side, side);
    EXPECT_LT(area_of(canvas.changed()), run < 10.0 ? side * side / 8 : side * side);
    Canvas fresh(side, side);
    EXPECT_TRUE(pixels == copy(fresh.draw(rope(run)), side, side)) << run;
  }
}

TEST(Canvas, DrawsNotTheInsideOfADiscThatMoves) {
  constexpr int side = 512;
  const auto disc = [&](double x) {
    Picture picture;
    picture.view = {{0.0, 0.0}, {side, side}};
    picture.add(Stroke{{x, 250.0}, {x, 250.0}, 230.0, 4.0, {0, 90, 140, 128}, ink});
    return picture;
  };
  Canvas canvas(side, side);
  canvas.draw(disc(240.0));
  for (const double x : {240.4, 243.0, 270.0}) {
    const auto pixels = copy(canvas.draw(disc(x)), side, side);
    EXPECT_LT(area_of(canvas.changed()), 2 * side * side / 3) << x;
    Canvas fresh(side, side);
    EXPECT_TRUE(pixels == copy(fresh.draw(disc(x)), side, side)) << x;
  }
}

TEST(Canvas, AShapeOfMorePiecesChangesItsOwnPlaceAlone) {
  const auto bent = [](double bend) {
    Picture picture = page();
    picture.add(Stroke{{80.0, 80.0}, {80.0, 80.0}, 10.0, 0.0, ink, ink});
    picture.points.push_back({{10.0, 10.0}, {1.0, 0.0}, 0.0});
    if (bend > 0.0) picture.points.push_back({{20.0, 10.0 + bend}, {1.0, 0.0}, 10.0});
    picture.points.push_back({{30.0, 10.0}, {1.0, 0.0}, 20.0});
    picture.add(Strip{0, picture.points.size(), 3.0, 1.0, 9.0, 2.0, orange, ink, brown});
    return picture;
  };
  Canvas canvas(size, size);
  canvas.draw(bent(0.0));
  const auto pixels = copy(canvas.draw(bent(2.0)), size, size);
  EXPECT_LT(area_of(canvas.changed()), size * size / 2);
  Canvas fresh(size, size);
  EXPECT_TRUE(pixels == copy(fresh.draw(bent(2.0)), size, size));
}

TEST(Canvas, PicturesSideBySideLookAsAlone) {
  const Scene scene = testing::atwood();
  Picture left, right = page();
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), left);
  right.add(
      Stroke{{-20.0, 48.0}, {60.0, 48.0}, 10.0, 0.0, ink, ink});  // would reach into the left one
  Canvas both(200, 100), one(100, 100);
  const std::array<const Picture*, 2> pictures = {&left, &right};
  const auto pair = copy(both.draw(pictures), 200, 100);
  for (int side = 0; side < 2; ++side) {
    const auto alone = copy(one.draw(*pictures[static_cast<std::size_t>(side)]), 100, 100);
    int worst = 0;
    for (int y = 0; y < 100; ++y) {
      for (int k = 0; k < 400; ++k) {
        const int d = pair[static_cast<std::size_t>(y * 800 + side * 400 + k)] -
                      alone[static_cast<std::size_t>(y * 400 + k)];
        worst = std::max(worst, std::abs(d));
      }
    }
    EXPECT_LE(worst, 1) << side;  // single precision places may differ in their last digit
  }
}

TEST(Canvas, RefusesAbsurdSizes) {
  for (const auto& [width, height] : {std::pair{0, 100}, {100, -1}, {15, 100}, {100, 1000000}}) {
    const std::string message =
        test::message_of<std::runtime_error>([w = width, h = height] { Canvas(w, h); });
    EXPECT_NE(message.find("each side must be 16 to 8192 px"), std::string::npos) << message;
  }
}

TEST(Canvas, OddSizesWork) {
  Picture picture = page();
  picture.add(Stroke{{48.0, 48.0}, {48.0, 48.0}, 30.0, 0.0, ink, ink});
  Canvas canvas(97, 51);
  EXPECT_EQ(canvas.draw(picture)[(25 * 97 + 48) * 4], ink.red);
}

TEST(Canvas, LabelsAreCentredAndInTheirColour) {
  Picture picture = page();
  picture.add(Label{{48.0, 48.0}, 20.0, "HOH", {0, 0, 0}});
  Canvas canvas(size, size);
  const std::uint8_t* pixels = canvas.draw(picture);
  double sum = 0.0, sum_x = 0.0;
  int left = size, right = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double dark = 255 - pixels[(y * size + x) * 4];
      sum += dark;
      sum_x += dark * (x + 0.5);
      if (dark > 128) {
        left = std::min(left, x);
        right = std::max(right, x);
      }
    }
  }
  EXPECT_GT(sum / 255.0, 60.0);  // px of ink
  EXPECT_NEAR(sum_x / sum, 48.0, 0.5);
  EXPECT_NEAR(0.5 * (left + right + 1), 48.0, 1.0);
}

TEST(Canvas, SaysWhichPackageBringsTheFont) {
  setenv("PINCHLAB_FONT", "/no/such/font.ttf", 1);
  const std::string message = test::message_of<std::runtime_error>([] { Canvas(32, 32); });
  unsetenv("PINCHLAB_FONT");
  EXPECT_NE(message.find("/no/such/font.ttf"), std::string::npos) << message;
}

}  // namespace
}  // namespace pinchlab
