// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/video.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "render/canvas.h"
#include "render/picture/compose.h"
#include "tests/base/full_disk.h"
#include "tests/base/message_of.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

using test::message_of;
using test::TemporaryFolder;

constexpr int width = 192, height = 160, frames = 75;

/// A swinging pair of loads, drawn; a few frames are enough for two groups of pictures.
std::vector<std::vector<std::uint8_t>> clip() {
  const Scene scene = testing::atwood();
  World world = make_world(scene, Method::pinch);
  Canvas canvas(width, height);
  Picture picture;
  std::vector<std::vector<std::uint8_t>> all;
  const Scenery scenery = set_scenery(scene);
  for (int i = 0; i < frames; ++i) {
    compose(scene, scenery, world, picture);
    const std::uint8_t* pixels = canvas.draw(picture);
    all.emplace_back(pixels, pixels + width * height * 4);
    for (double& angle : world.angle) angle += 0.05;
    world.position[1].y() -= 0.01;
  }
  return all;
}

const std::vector<std::vector<std::uint8_t>>& drawn() {
  static const auto all = clip();
  return all;
}

VideoSettings settings(Codec codec) {
  return {codec, width, height, 60, ""};
}

void write(const std::string& path, const VideoSettings& how) {
  VideoWriter writer(path, how);
  for (const auto& frame : drawn()) writer.add(frame.data());
  writer.finish();
}

/// Peak signal-to-noise ratio of RGB, dB.
double psnr_db(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (i % 4 == 3) continue;
    const double d = a[i] - b[i];
    sum += d * d;
  }
  const double samples = 0.75 * static_cast<double>(a.size());
  return sum > 0.0 ? 10.0 * std::log10(255.0 * 255.0 * samples / sum) : 999.0;
}

class EveryCodec : public ::testing::TestWithParam<Codec> {};

TEST_P(EveryCodec, ReadsBackAsWritten) {
  const Codec codec = GetParam();
  const bool rgb = codec == Codec::ffv1;
  const TemporaryFolder folder;
  const std::string path = folder.file(std::string("clip") + file_ending(codec));
  write(path, settings(codec));
  EXPECT_FALSE(std::filesystem::exists(path + ".partial"));

  VideoReader reader(path);
  const VideoInfo& info = reader.info();
  EXPECT_EQ(info.codec, to_string(codec));
  EXPECT_NE(info.container.find(codec == Codec::h264 ? "mp4" : "matroska"), std::string::npos);
  EXPECT_EQ(info.width, width);
  EXPECT_EQ(info.height, height);
  EXPECT_EQ(info.frames_per_second, 60);
  EXPECT_EQ(info.pixel_format, rgb ? "bgr0" : "yuv420p");
  EXPECT_EQ(info.colour_primaries, "bt709");
  EXPECT_EQ(info.colour_space, rgb ? "gbr" : "bt709");
  EXPECT_EQ(info.colour_transfer, rgb ? "iec61966-2-1" : "bt709");
  EXPECT_EQ(info.colour_range, rgb ? "pc" : "tv");

  int count = 0;
  while (const auto frame = reader.next()) {
    ASSERT_LT(count, frames);
    // WebM and Matroska keep times in ms.
    EXPECT_NEAR(frame->time_s, count / 60.0, codec == Codec::h264 ? 1e-9 : 0.00051) << count;
    const auto& original = drawn()[static_cast<std::size_t>(count)];
    if (rgb) {
      for (std::size_t i = 0; i < original.size(); ++i) {
        if (i % 4 != 3) {
          ASSERT_EQ(frame->rgba[i], original[i]) << "frame " << count;
        }
      }
    } else {
      // Thin coloured edges lose at 4:2:0 whatever the encoder does.
      EXPECT_GT(psnr_db(frame->rgba, original), 30.0) << count;
    }
    if (count == 0) {
      EXPECT_TRUE(frame->key);
    }
    ++count;
  }
  EXPECT_EQ(count, frames);
}

TEST_P(EveryCodec, SameFramesSameBytes) {
  const TemporaryFolder folder;
  write(folder.file("a"), settings(GetParam()));
  write(folder.file("b"), settings(GetParam()));
  EXPECT_EQ(testing::bytes_of(folder.file("a")), testing::bytes_of(folder.file("b")));
}

TEST_P(EveryCodec, AnInterruptedWriteLeavesNothing) {
  const TemporaryFolder folder;
  {
    VideoWriter writer(folder.file("clip"), settings(GetParam()));
    for (int i = 0; i < 20; ++i) writer.add(drawn()[static_cast<std::size_t>(i)].data());
    EXPECT_FALSE(std::filesystem::exists(folder.file("clip")));
    EXPECT_TRUE(std::filesystem::exists(folder.file("clip.partial")));
  }
  EXPECT_TRUE(folder.empty());
}

TEST_P(EveryCodec, OnlyChangesMayBeConverted) {
  // Two frames that differ in a patch: naming the patch gives the same file as converting all.
  auto second = drawn()[0];
  for (int y = 40; y < 60; ++y)
    std::fill_n(second.begin() + (y * width + 70) * 4, 20 * 4, std::uint8_t{90});
  const PixelRect patch{70, 40, 20, 20};
  const TemporaryFolder folder;
  for (const bool patched : {false, true}) {
    VideoWriter writer(folder.file(patched ? "patched" : "whole"), settings(GetParam()));
    writer.add(drawn()[0].data());
    if (patched) {
      writer.add(second.data(), std::span(&patch, 1));
    } else {
      writer.add(second.data());
    }
    writer.finish();
  }
  EXPECT_EQ(testing::bytes_of(folder.file("patched")), testing::bytes_of(folder.file("whole")));
}

TEST_P(EveryCodec, TheFirstFrameIsConvertedWhole) {
  // A canvas that has drawn before names only what it changed; a new clip knows nothing of that.
  const TemporaryFolder folder;
  for (const bool nothing : {false, true}) {
    VideoWriter writer(folder.file(nothing ? "nothing" : "whole"), settings(GetParam()));
    if (nothing) {
      writer.add(drawn()[0].data(), {});
    } else {
      writer.add(drawn()[0].data());
    }
    writer.finish();
  }
  EXPECT_EQ(testing::bytes_of(folder.file("nothing")), testing::bytes_of(folder.file("whole")));
}

INSTANTIATE_TEST_SUITE_P(Video, EveryCodec, ::testing::Values(Codec::h264, Codec::vp9, Codec::ffv1),
                         [](const auto& codec) { return std::string(to_string(codec.param)); });

TEST(Video, H264IsMadeForPlayersAndStimuli) {
  const TemporaryFolder folder;
  write(folder.file("clip.mp4"), settings(Codec::h264));
  const auto bytes = testing::bytes_of(folder.file("clip.mp4"));
  const auto find = [&](const char* tag) {
    return std::search(bytes.begin(), bytes.end(), tag, tag + 4) - bytes.begin();
  };
  EXPECT_LT(find("moov"), find("mdat")) << "faststart";
  EXPECT_LT(find("colr"), find("mdat")) << "tagged in the container too";
  EXPECT_EQ(find("btrt"), std::ssize(bytes)) << "no bit rates, which would tell a pair apart";

  // A key frame a second, and luma close in every frame.
  VideoReader reader(folder.file("clip.mp4"));
  for (int i = 0; i < frames; ++i) {
    const auto frame = reader.next();
    ASSERT_TRUE(frame);
    if (i % 60 == 0) {
      EXPECT_TRUE(frame->key) << i;
    }
    double sum = 0.0;
    for (int p = 0; p < width * height; ++p) {
      const std::uint8_t* c = drawn()[static_cast<std::size_t>(i)].data() + 4 * p;
      const double luma = 16.0 + 219.0 / 255.0 * (0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]);
      sum += std::pow(luma - frame->luma[static_cast<std::size_t>(p)], 2.0);
    }
    EXPECT_GT(10.0 * std::log10(255.0 * 255.0 * width * height / sum), 46.0) << i;
  }
}

TEST(Video, BadSettingsAreNamedAndLeaveNothing) {
  const TemporaryFolder folder;
  const auto error = [&](VideoSettings how) {
    return message_of<std::invalid_argument>([&] { VideoWriter(folder.file("clip"), how); });
  };
  VideoSettings odd = settings(Codec::h264), huge = odd, frozen = odd, strange = odd, garbled = odd;
  odd.width = 191;
  huge.height = 100000;
  frozen.frames_per_second = 0;
  strange.encoder_options = "presett=veryfast";
  garbled.encoder_options = "nonsense";
  EXPECT_NE(error(odd).find("use even sides, or ffv1"), std::string::npos) << error(odd);
  EXPECT_NE(error(huge).find("16 to 8192 px"), std::string::npos) << error(huge);
  EXPECT_NE(error(frozen).find("1 to 1000"), std::string::npos) << error(frozen);
  EXPECT_NE(error(strange).find("\"presett\" is unknown"), std::string::npos) << error(strange);
  EXPECT_NE(error(garbled).find("key=value"), std::string::npos) << error(garbled);
  EXPECT_TRUE(folder.empty());
}

TEST(Video, BadPlacesAreNamedAndLeaveNothing) {
  const TemporaryFolder folder;
  const std::string lost = folder.file("missing/clip.mp4");
  EXPECT_NE(
      message_of<std::runtime_error>([&] { VideoWriter(lost, settings(Codec::h264)); }).find(lost),
      std::string::npos);
  EXPECT_NE(message_of<std::runtime_error>([&] {
              VideoWriter(folder.path().string(), settings(Codec::h264));
            }).find("is a folder"),
            std::string::npos);
  const std::string empty_clip = message_of<std::runtime_error>(
      [&] { VideoWriter(folder.file("clip"), settings(Codec::h264)).finish(); });
  EXPECT_NE(empty_clip.find("at least one frame"), std::string::npos);
  EXPECT_TRUE(folder.empty());
}

TEST(Video, AFullDiskIsAnErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  for (const Codec codec : {Codec::h264, Codec::vp9, Codec::ffv1}) {
    const test::FullDisk full(100);
    EXPECT_THROW(write(folder.file("clip"), settings(codec)), std::runtime_error)
        << to_string(codec);
    EXPECT_TRUE(folder.empty());
  }
}

TEST(Video, OddSizesWorkInFfv1) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> grey(33 * 17 * 4, 90);
  {
    VideoWriter writer(folder.file("odd.mkv"), {Codec::ffv1, 33, 17, 30, ""});
    writer.add(grey.data());
    writer.finish();
  }
  VideoReader reader(folder.file("odd.mkv"));
  const auto frame = reader.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(reader.info().width, 33);
  EXPECT_EQ(frame->rgba[0], 90);
}

TEST(Video, UnreadableFilesAreNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("no.mp4")) << "not a video";
  EXPECT_NE(
      message_of<std::runtime_error>([&] { VideoReader(folder.file("no.mp4")); }).find("no.mp4"),
      std::string::npos);
  EXPECT_THROW(VideoReader(folder.file("missing.mp4")), std::runtime_error);
}

TEST(Video, NamesGoThereAndBack) {
  for (const Codec codec : {Codec::h264, Codec::vp9, Codec::ffv1})
    EXPECT_EQ(codec_from_string(to_string(codec)), codec);
  EXPECT_NE(
      message_of<std::invalid_argument>([] { codec_from_string("h265"); }).find("h264, vp9, ffv1"),
      std::string::npos);
  EXPECT_NE(describe(settings(Codec::h264)).find("crf="), std::string::npos);
}

}  // namespace
}  // namespace pinchlab
