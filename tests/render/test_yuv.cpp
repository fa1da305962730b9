// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/yuv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pinchlab {
namespace {

TEST(Yuv, EverySampleIsTheNearestToItsExactValue) {
  // All combinations of 18 levels a channel, in 2 x 2 blocks of neighbours.
  const int width = 108, height = 54;
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < width * height; ++i) {
    for (const int level : {i % 18, i / 18 % 18, i / 324})
      rgba.push_back(static_cast<std::uint8_t>(level * 15));
    rgba.push_back(255);
  }
  std::vector<std::uint8_t> y(width * height), u(width * height / 4), v(u.size());
  rgba_to_yuv420(rgba.data(), width, {0, 0, width, height},
                 {y.data(), u.data(), v.data(), width, width / 2, width / 2});

  const auto luma = [](const double* c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
  for (int j = 0; j < height; j += 2) {
    for (int i = 0; i < width; i += 2) {
      double mean[3] = {0.0, 0.0, 0.0};
      for (int k = 0; k < 4; ++k) {
        const int at = (j + k / 2) * width + i + k % 2;
        double pixel[3];
        for (int c = 0; c < 3; ++c)
          mean[c] += 0.25 * (pixel[c] = rgba[static_cast<std::size_t>(4 * at + c)]);
        ASSERT_NEAR(y[static_cast<std::size_t>(at)], 16.0 + 219.0 / 255.0 * luma(pixel), 0.52);
      }
      const auto block = static_cast<std::size_t>(j / 2 * (width / 2) + i / 2);
      ASSERT_NEAR(u[block], 128.0 + 224.0 / 255.0 * (mean[2] - luma(mean)) / 1.8556, 0.52);
      ASSERT_NEAR(v[block], 128.0 + 224.0 / 255.0 * (mean[0] - luma(mean)) / 1.5748, 0.52);
    }
  }
}

TEST(Yuv, WideAndNarrowPartsGiveTheSameBytes) {
  // Parts of 16 px and more take a path of their own.
  const int width = 64, height = 32;
  std::vector<std::uint8_t> rgba;
  for (std::uint32_t i = 0; i < 4 * width * height; ++i)
    rgba.push_back(static_cast<std::uint8_t>(i * 2654435761u >> 24));
  const auto convert = [&](int part) {
    std::vector<std::uint8_t> planes(width * height * 3 / 2);
    std::uint8_t* const u = planes.data() + width * height;
    for (int x = 0; x < width; x += part) {
      rgba_to_yuv420(rgba.data(), width, {x, 0, part, height},
                     {planes.data(), u, u + width * height / 4, width, width / 2, width / 2});
    }
    return planes;
  };
  EXPECT_EQ(convert(64), convert(2));
}

TEST(Yuv, ConvertsOnlyThePartAskedFor) {
  const int width = 16, height = 8;
  const std::vector<std::uint8_t> rgba(static_cast<std::size_t>(width) * height * 4, 255);
  std::vector<std::uint8_t> y(width * height, 1), u(width * height / 4, 1), v(u.size(), 1);
  rgba_to_yuv420(rgba.data(), width, {4, 2, 6, 4},
                 {y.data(), u.data(), v.data(), width, width / 2, width / 2});
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const bool inside = i >= 4 && i < 10 && j >= 2 && j < 6;
      EXPECT_EQ(y[static_cast<std::size_t>(j * width + i)], inside ? 235 : 1);
      EXPECT_EQ(u[static_cast<std::size_t>(j / 2 * width / 2 + i / 2)], inside ? 128 : 1);
    }
  }
}

}  // namespace
}  // namespace pinchlab
