// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>

#include "tests/base/full_disk.h"
#include "tests/base/message_of.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

using test::message_of;
using test::TemporaryFolder;

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  bool opaque = false;
};

Image read(const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&png, path.c_str()) == 0)
    throw std::runtime_error(png.message);
  Image image{static_cast<int>(png.width),
              static_cast<int>(png.height),
              {},
              (png.format & PNG_FORMAT_FLAG_ALPHA) == 0};
  png.format = PNG_FORMAT_RGB;
  image.rgb.resize(PNG_IMAGE_SIZE(png));
  png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr);
  return image;
}

std::vector<std::uint8_t> gradient(int width, int height) {
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < width * height; ++i) {
    for (const int c : {i, 3 * i, i / width, 255}) rgba.push_back(static_cast<std::uint8_t>(c));
  }
  return rgba;
}

TEST(Png, ReadsBackAsWritten) {
  const TemporaryFolder folder;
  const auto rgba = gradient(37, 21);
  write_png(folder.file("a.png"), 37, 21, rgba.data());
  const Image image = read(folder.file("a.png"));
  ASSERT_EQ(image.width, 37);
  ASSERT_EQ(image.height, 21);
  EXPECT_TRUE(image.opaque);
  for (std::size_t i = 0; i < 37 * 21; ++i) {
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(image.rgb[3 * i + c], rgba[4 * i + c]);
  }
}

TEST(Png, SamePixelsSameBytes) {
  const TemporaryFolder folder;
  const auto rgba = gradient(64, 64);
  write_png(folder.file("a.png"), 64, 64, rgba.data());
  write_png(folder.file("b.png"), 64, 64, rgba.data());
  EXPECT_EQ(testing::bytes_of(folder.file("a.png")), testing::bytes_of(folder.file("b.png")));
}

TEST(Png, ContactSheetShowsEveryFrameOverItsLabel) {
  const TemporaryFolder folder;
  const int w = 120, h = 80;
  std::vector<SheetFrame> frames;
  for (int i = 0; i < 5; ++i) {
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(w * h * 4),
                                   static_cast<std::uint8_t>(40 * i));
    for (std::size_t k = 3; k < rgba.size(); k += 4) rgba[k] = 255;
    frames.push_back({rgba, "t = 1.25 s"});
  }
  contact_sheet(folder.file("sheet.png"), w, h, frames, 3);
  const Image sheet = read(folder.file("sheet.png"));
  const int gap = 4, strip = 24;
  EXPECT_EQ(sheet.width, gap + 3 * (w + gap));
  EXPECT_EQ(sheet.height, gap + 2 * (h + strip));
  const auto red = [&](int x, int y) {
    return sheet.rgb[static_cast<std::size_t>(y * sheet.width + x) * 3];
  };
  for (int i = 0; i < 5; ++i) {
    const int left = gap + i % 3 * (w + gap), top = gap + i / 3 * (h + strip);
    EXPECT_EQ(red(left, top), 40 * i);
    EXPECT_EQ(red(left + w - 1, top + h - 1), 40 * i);
    int dark = 0;
    for (int y = top + h; y < top + h + strip && y < sheet.height; ++y) {
      for (int x = left; x < left + w; ++x) dark += red(x, y) < 128;
    }
    EXPECT_GT(dark, 30) << "label of frame " << i;
  }
}

TEST(Png, ContactSheetsHaveTheThemesColours) {
  const TemporaryFolder folder;
  Theme theme;
  theme.background = {10, 20, 30, 255};
  theme.ink = {250, 240, 230, 255};
  const std::vector<std::uint8_t> rgba(4 * 120 * 80, 255);
  contact_sheet(folder.file("sheet.png"), 120, 80, {{rgba, "t = 1.25 s"}, {rgba, "t = 2 s"}}, 2,
                theme);
  const Image sheet = read(folder.file("sheet.png"));
  EXPECT_EQ(std::vector<int>(sheet.rgb.begin(), sheet.rgb.begin() + 3),
            (std::vector<int>{10, 20, 30}));
  const std::size_t below = static_cast<std::size_t>(3 * sheet.width * (4 + 80));
  const auto brightest =
      std::max_element(sheet.rgb.begin() + static_cast<std::ptrdiff_t>(below), sheet.rgb.end());
  EXPECT_EQ(*brightest, 250) << "the labels' ink";
  theme.background.alpha = 0;
  contact_sheet(folder.file("clear.png"), 120, 80, {{rgba, "A"}, {rgba, "B"}}, 2, theme);
  EXPECT_FALSE(read(folder.file("clear.png")).opaque);
}

TEST(Png, LabelsOfSmallPicturesAreSmaller) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> rgba(4 * 80 * 40, 255);
  const SheetFrame frame{rgba, "pinch joints, no contact, 1.25 s"};
  contact_sheet(folder.file("sheet.png"), 80, 40, {frame, frame}, 2);
  const Image sheet = read(folder.file("sheet.png"));
  const std::uint8_t paper = Theme().background.red;
  for (int y = 0; y < sheet.height; ++y) {
    for (const int x : {0, 4 + 80 + 2, sheet.width - 1}) {  // what is beside them
      EXPECT_EQ(sheet.rgb[static_cast<std::size_t>(y * sheet.width + x) * 3], paper)
          << x << ' ' << y;
    }
  }
}

TEST(Png, ErrorsNameTheFileAndLeaveNothing) {
  const TemporaryFolder folder;
  const auto rgba = gradient(8, 8);
  const std::string lost = folder.file("missing/a.png");
  EXPECT_NE(message_of<std::runtime_error>([&] { write_png(lost, 8, 8, rgba.data()); }).find(lost),
            std::string::npos);
  EXPECT_THROW(write_png(folder.path().string(), 8, 8, rgba.data()), std::runtime_error);
  EXPECT_THROW(write_png(folder.file("a.png"), 0, 8, rgba.data()), std::invalid_argument);
  EXPECT_THROW(contact_sheet(folder.file("a.png"), 8, 8, {}), std::invalid_argument);
  EXPECT_THROW(contact_sheet(folder.file("a.png"), 8, 8, {{gradient(4, 4), "small"}}),
               std::invalid_argument);
  EXPECT_TRUE(folder.empty());
}

TEST(Png, AFullDiskLeavesNothing) {
  const TemporaryFolder folder;
  const auto rgba = gradient(400, 400);
  const test::FullDisk full(100);
  EXPECT_THROW(write_png(folder.file("a.png"), 400, 400, rgba.data()), std::runtime_error);
  EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace pinchlab
