// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/equal_sizes.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/base/message_of.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

using test::message_of;
using test::TemporaryFolder;

constexpr int width = 64, height = 48, frames = 40;

/// A clip of noise that differs in `share` of its rows, so that frames' sizes do.
void write_clip(const std::string& path, Codec codec, double share, int count = frames) {
  VideoWriter writer(path, {codec, width, height, 30, ""});
  std::uint32_t state = 7;
  for (int i = 0; i < count; ++i) {
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(width) * height * 4, 200);
    const auto noisy = static_cast<std::size_t>(share * static_cast<double>(rgba.size()));
    for (std::size_t k = 0; k < noisy; ++k) {
      state = state * 1664525 + 1013904223;
      rgba[k] = static_cast<std::uint8_t>(state >> 24);
    }
    writer.add(rgba.data());
  }
  writer.finish();
}

std::vector<DecodedFrame> frames_of(const std::string& path) {
  VideoReader reader(path);
  std::vector<DecodedFrame> all;
  while (const auto frame = reader.next()) all.push_back(*frame);
  return all;
}

class EqualSizes : public ::testing::TestWithParam<Codec> {
 protected:
  std::string file(const std::string& name) const {
    return folder_.file(name + file_ending(GetParam()));
  }
  TemporaryFolder folder_;
};

TEST_P(EqualSizes, SameSizeAndThePicturesUntouched) {
  const std::vector<std::string> from = {file("none"), file("some"), file("all")};
  const std::vector<std::string> to = {file("none-padded"), file("some-padded"),
                                       file("all-padded")};
  write_clip(from[0], GetParam(), 0.0);
  write_clip(from[1], GetParam(), 0.3);
  write_clip(from[2], GetParam(), 1.0);
  equal_sizes(GetParam(), from, to);
  for (std::size_t i = 0; i < from.size(); ++i) {
    EXPECT_EQ(std::filesystem::file_size(to[i]), std::filesystem::file_size(to[0]));
    const auto before = frames_of(from[i]), after = frames_of(to[i]), first = frames_of(to[0]);
    ASSERT_EQ(before.size(), static_cast<std::size_t>(frames));
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t k = 0; k < before.size(); ++k) {
      EXPECT_EQ(after[k].rgba, before[k].rgba) << i << " " << k;
      EXPECT_EQ(after[k].time_s, before[k].time_s) << i << " " << k;
      EXPECT_EQ(after[k].key, first[k].key) << i << " " << k;
      if (GetParam() == Codec::h264) {
        EXPECT_EQ(after[k].stored_bytes, first[k].stored_bytes) << i << " " << k;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Video, EqualSizes, ::testing::Values(Codec::h264, Codec::vp9, Codec::ffv1),
                         [](const auto& codec) { return std::string(to_string(codec.param)); });

TEST(EqualSizesOfH264, EqualOnesAreCopiedByteByByte) {
  const TemporaryFolder folder;
  write_clip(folder.file("a.mp4"), Codec::h264, 0.5);
  write_clip(folder.file("b.mp4"), Codec::h264, 0.5);
  equal_sizes(Codec::h264, {folder.file("a.mp4"), folder.file("b.mp4")},
              {folder.file("c.mp4"), folder.file("d.mp4")});
  EXPECT_EQ(testing::bytes_of(folder.file("c.mp4")), testing::bytes_of(folder.file("a.mp4")));
  EXPECT_EQ(testing::bytes_of(folder.file("d.mp4")), testing::bytes_of(folder.file("a.mp4")));
}

TEST(EqualSizesOfH264, ClipsOfDifferentLengthsAreRefused) {
  const TemporaryFolder folder;
  write_clip(folder.file("a.mp4"), Codec::h264, 0.5);
  write_clip(folder.file("b.mp4"), Codec::h264, 0.5, frames - 1);
  const std::string error = message_of<std::runtime_error>([&] {
    equal_sizes(Codec::h264, {folder.file("a.mp4"), folder.file("b.mp4")},
                {folder.file("c.mp4"), folder.file("d.mp4")});
  });
  EXPECT_NE(error.find("its frames are not stored in the order of"), std::string::npos) << error;
  EXPECT_FALSE(std::filesystem::exists(folder.file("c.mp4")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("c.mp4.partial")));
}

TEST(EqualSizesOfH264, BrokenFilesAreNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("a.mp4")) << "no video";
  const std::string error = message_of<std::runtime_error>(
      [&] { equal_sizes(Codec::h264, {folder.file("a.mp4")}, {folder.file("b.mp4")}); });
  EXPECT_NE(error.find("a.mp4: cannot be read"), std::string::npos) << error;
}

}  // namespace
}  // namespace pinchlab
