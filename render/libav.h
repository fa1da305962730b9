// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What libav_writer.cpp, libav_reader.cpp and equal_sizes.cpp share, the only files that know
// FFmpeg's libraries.

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <fmt/format.h>

#include <array>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

namespace pinchlab::libav {

/// For MP4. No bit rates are written (`btrt`): the two files of a pair may differ in them, which
/// would tell them apart.
constexpr const char* mp4_options = "movflags=+faststart+write_colr:write_btrt=0";

/// What FFmpeg says of an error code.
inline std::string reason(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

/// Throws std::runtime_error that names the file, what could not be done, and why.
inline void check(int result, const std::string& path, const char* what) {
  if (result < 0) throw std::runtime_error(fmt::format("{}: {}: {}", path, what, reason(result)));
}

/// Throws std::bad_alloc instead of a null pointer.
template <typename Pointer>
Pointer* made(Pointer* pointer) {
  if (pointer == nullptr) throw std::bad_alloc();
  return pointer;
}

struct Delete {
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
template <typename Type>
using Owned = std::unique_ptr<Type, Delete>;

}  // namespace pinchlab::libav
