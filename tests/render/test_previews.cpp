// SPDX-License-Identifier: GPL-3.0-or-later
// Animated PNG, WebP and GIF.

#include <gtest/gtest.h>

#include <cmath>

#include "render/canvas.h"
#include "render/palette.h"
#include "render/video.h"
#include "tests/base/message_of.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

using test::message_of;
using test::TemporaryFolder;

constexpr int width = 33, height = 18, frames = 5, rate = 25;

/// A red square that moves over white.
std::vector<std::uint8_t> frame(int i) {
  std::vector<std::uint8_t> rgba(width * height * 4, 255);
  for (int y = 4; y < 10; ++y) {
    for (int x = 2 * i; x < 2 * i + 6; ++x) {
      rgba[static_cast<std::size_t>(4 * (y * width + x) + 1)] = 0;
      rgba[static_cast<std::size_t>(4 * (y * width + x) + 2)] = 0;
    }
  }
  return rgba;
}

void write(const std::string& path, Codec codec) {
  VideoWriter writer(path, {codec, width, height, rate, ""});
  for (int i = 0; i < frames; ++i) writer.add(frame(i).data());
  writer.finish();
}

std::size_t count(const std::string& bytes, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = bytes.find(what); at != std::string::npos; at = bytes.find(what, at + 1))
    ++found;
  return found;
}

TEST(Preview, PngAndGifReadBackWithoutLoss) {
  for (const Codec codec : {Codec::apng, Codec::gif}) {
    const TemporaryFolder folder;
    const std::string path = folder.file(std::string("clip") + file_ending(codec));
    write(path, codec);
    VideoReader reader(path);
    int i = 0;
    while (const auto decoded = reader.next()) {
      EXPECT_NEAR(decoded->time_s, static_cast<double>(i) / rate, 1e-9);
      const auto expected = frame(i);
      ASSERT_EQ(decoded->rgba.size(), expected.size());
      for (std::size_t k = 0; k < expected.size(); ++k) {
        if (k % 4 != 3) {
          ASSERT_NEAR(decoded->rgba[k], expected[k], 1) << to_string(codec) << " frame " << i;
        }
      }
      ++i;
    }
    EXPECT_EQ(i, frames);
  }
}

// This FFmpeg writes animated WebP but does not read it: the file's own structure is looked at.
TEST(Preview, WebPHasItsFramesAndLoops) {
  const TemporaryFolder folder;
  write(folder.file("clip.webp"), Codec::webp);
  const auto raw = testing::bytes_of(folder.file("clip.webp"));
  const std::string bytes(raw.begin(), raw.end());
  EXPECT_EQ(bytes.substr(0, 4), "RIFF");
  EXPECT_EQ(bytes.substr(8, 4), "WEBP");
  EXPECT_EQ(count(bytes, "ANMF"), static_cast<std::size_t>(frames));
  const std::size_t anim = bytes.find("ANIM");
  ASSERT_NE(anim, std::string::npos);
  EXPECT_EQ(bytes.substr(anim + 12, 2), std::string(2, '\0')) << "plays for ever";
}

TEST(Preview, SameFramesSameBytes) {
  for (const Codec codec : {Codec::apng, Codec::webp, Codec::gif}) {
    const TemporaryFolder folder;
    write(folder.file("a"), codec);
    write(folder.file("b"), codec);
    EXPECT_EQ(testing::bytes_of(folder.file("a")), testing::bytes_of(folder.file("b")));
  }
}

TEST(Preview, AGifsClockIsChecked) {
  const TemporaryFolder folder;
  const std::string error = message_of<std::invalid_argument>([&] {
    VideoWriter(folder.file("a.gif"), {Codec::gif, 32, 32, 60, ""});
  });
  EXPECT_NE(error.find("--fps 50"), std::string::npos) << error;
  EXPECT_THROW(check_video("a.gif", {Codec::gif, 32, 32, 0, ""}), std::invalid_argument);
  EXPECT_TRUE(folder.empty());
}

TEST(Palette, HoldsTheFrequentColoursAndFindsTheNearest) {
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < 300; ++i) {
    const std::uint8_t grey = i < 200 ? 200 : 40;
    rgba.insert(rgba.end(), {grey, grey, grey, 255});
  }
  Palette palette(rgba.data(), 300, 1);
  EXPECT_EQ(palette.argb()[0], 0xffc8c8c8u);
  EXPECT_EQ(palette.argb()[1], 0xff282828u);
  const std::vector<std::uint8_t> other = {190, 205, 200, 255, 50, 30, 44, 255};
  std::uint8_t index[2] = {9, 9};
  palette.index(other.data(), 2, {0, 0, 2, 1}, index, 2);
  EXPECT_EQ(index[0], 0);
  EXPECT_EQ(index[1], 1);
}

}  // namespace
}  // namespace pinchlab
