// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Frames to a video file, and back for checking.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/pixel_rect.h"

namespace pinchlab {

enum class Codec {
  h264,  ///< H.264 in MP4, 4:2:0
  vp9,   ///< VP9 in WebM, 4:2:0
  ffv1,  ///< FFV1 in Matroska, lossless RGB
  apng,  ///< animated PNG, lossless; this and the next two are previews that play for ever
  webp,  ///< animated WebP, lossless
  gif,   ///< animated GIF of 256 colours; its clock counts hundredths of a second
};

/// Whether the codec stores colour for 2 x 2 px.
bool needs_even_sides(Codec codec);

/// "h264", "vp9", "ffv1", "apng", "webp" or "gif", and back; codec_from_string throws
/// std::invalid_argument that lists them.
const char* to_string(Codec codec);
Codec codec_from_string(const std::string& name);

/// The ending of a codec's files, with its dot, such as ".mp4".
const char* file_ending(Codec codec);

struct VideoSettings {
  Codec codec = Codec::h264;
  int width = 960, height = 960;  // px; even unless ffv1
  int frames_per_second = 60;     // 1..1000
  /// Encoder options "key=value:key=value" instead of the ones chosen for stimuli; empty: those.
  std::string encoder_options;
};

/// Throws std::invalid_argument for settings that cannot be, with what to do; `path` is the file's.
void check_video(const std::string& path, const VideoSettings& settings);

/// One line for a manifest: codec, pixel format, colour and every encoder option.
std::string describe(const VideoSettings& settings);

/// Writes a video: frame i is shown at i / frames_per_second. The same frames give the same bytes
/// in every run on any processor. The file appears under its name only when finish() returns; until
/// then it is a PartialFile, which is removed if the writer is destroyed unfinished.
///
/// Throws as check_video does, and std::runtime_error where the file cannot be written.
class VideoWriter {
 public:
  VideoWriter(const std::string& path, const VideoSettings& settings);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// One frame: RGBA, 8 bits each, top row first, width * 4 bytes a row; alpha is ignored.
  void add(const std::uint8_t* rgba);

  /// The same, where all pixels outside the rectangles are those of the last frame added: they are
  /// not converted again. Left, top, width and height are even unless ffv1. Canvas::changed() gives
  /// them.
  void add(const std::uint8_t* rgba, std::span<const PixelRect> changed);

  /// Completes the file and gives it its name.
  void finish();

  /// Processor time of the last add(), s: conversion to the codec's pixel format, and encoding.
  double convert_seconds() const;
  double encode_seconds() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What a reader knows of a file before decoding it.
struct VideoInfo {
  std::string container, codec, pixel_format;  // as libavformat and libavcodec name them
  std::string colour_space, colour_range, colour_primaries, colour_transfer;
  int width = 0, height = 0;  // px
  int frames_per_second = 0;
};

struct DecodedFrame {
  double time_s = 0.0;             // presentation time
  bool key = false;                // decoding can start here
  int stored_bytes = 0;            // in the file
  std::vector<std::uint8_t> luma;  // width * height, as stored; empty for RGB codecs
  std::vector<std::uint8_t> rgba;  // width * height * 4
};

/// Reads a video back, to check it. Throws std::runtime_error where it cannot be read.
class VideoReader {
 public:
  explicit VideoReader(const std::string& path);
  ~VideoReader();
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;

  const VideoInfo& info() const;
  std::optional<DecodedFrame> next();  // in order of presentation; none after the last

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pinchlab
