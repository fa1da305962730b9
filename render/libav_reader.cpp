// SPDX-License-Identifier: GPL-3.0-or-later
// Reads videos by FFmpeg's libraries.

#include "render/libav.h"
#include "render/video.h"

namespace pinchlab {

using libav::check;
using libav::made;
using libav::Owned;

struct VideoReader::State {
  std::string path;
  AVFormatContext* format = nullptr;
  AVStream* stream = nullptr;
  Owned<AVCodecContext> codec;
  Owned<AVFrame> frame;
  Owned<AVPacket> packet;
  Owned<SwsContext> scaler;
  VideoInfo info;

  explicit State(const std::string& path_) : path(path_) {
    av_log_set_level(AV_LOG_FATAL);  // errors are thrown instead
    try {
      open();
    } catch (...) {
      avformat_close_input(&format);
      throw;
    }
  }
  ~State() { avformat_close_input(&format); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void open() {
    check(avformat_open_input(&format, path.c_str(), nullptr, nullptr), path, "cannot be read");
    check(avformat_find_stream_info(format, nullptr), path, "cannot be read");
    const AVCodec* decoder = nullptr;
    const int index = av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
    check(index, path, "has no video that can be read");
    stream = format->streams[index];
    codec.reset(made(avcodec_alloc_context3(decoder)));
    check(avcodec_parameters_to_context(codec.get(), stream->codecpar), path, "cannot be read");
    codec->thread_count = 1;
    check(avcodec_open2(codec.get(), decoder, nullptr), path, "cannot be decoded");
    frame.reset(made(av_frame_alloc()));
    packet.reset(made(av_packet_alloc()));

    const auto text = [](const char* name) { return std::string(name == nullptr ? "" : name); };
    const AVCodecParameters& p = *stream->codecpar;
    const auto pixel_format = static_cast<AVPixelFormat>(p.format);
    info = {text(format->iformat->name),
            text(avcodec_get_name(p.codec_id)),
            text(av_get_pix_fmt_name(pixel_format)),
            text(av_color_space_name(p.color_space)),
            text(av_color_range_name(p.color_range)),
            text(av_color_primaries_name(p.color_primaries)),
            text(av_color_transfer_name(p.color_trc)),
            p.width,
            p.height,
            stream->avg_frame_rate.den == 1 ? stream->avg_frame_rate.num : 0};
    scaler.reset(sws_getContext(p.width, p.height, pixel_format, p.width, p.height, AV_PIX_FMT_RGBA,
                                SWS_BILINEAR | SWS_FULL_CHR_H_INT | SWS_ACCURATE_RND, nullptr,
                                nullptr, nullptr));
    if (!scaler) throw std::runtime_error(path + ": its pixel format cannot be shown");
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(scaler.get(), bt709, 0, bt709, 1, 0, 1 << 16, 1 << 16);
  }

  bool decode() {
    for (;;) {
      const int result = avcodec_receive_frame(codec.get(), frame.get());
      if (result == 0) return true;
      if (result == AVERROR_EOF) return false;
      if (result != AVERROR(EAGAIN)) check(result, path, "cannot be decoded");
      int read = 0;
      do {
        av_packet_unref(packet.get());
        read = av_read_frame(format, packet.get());
      } while (read == 0 && packet->stream_index != stream->index);
      if (read != 0 && read != AVERROR_EOF) check(read, path, "cannot be read");
      check(avcodec_send_packet(codec.get(), read == 0 ? packet.get() : nullptr), path,
            "cannot be decoded");
    }
  }

  DecodedFrame take() {
    const int w = info.width, h = info.height;
    const auto row = static_cast<std::size_t>(w);
    DecodedFrame out;
    out.time_s = static_cast<double>(frame->best_effort_timestamp) * av_q2d(stream->time_base);
    out.key = frame->key_frame != 0;
    out.stored_bytes = frame->pkt_size;
    if (frame->format == AV_PIX_FMT_YUV420P) {
      for (int y = 0; y < h; ++y) {
        const std::uint8_t* from = frame->data[0] + std::ptrdiff_t{y} * frame->linesize[0];
        out.luma.insert(out.luma.end(), from, from + row);
      }
    }
    out.rgba.resize(row * static_cast<std::size_t>(h) * 4);
    std::uint8_t* const to[4] = {out.rgba.data(), nullptr, nullptr, nullptr};
    const int to_stride[4] = {w * 4, 0, 0, 0};
    sws_scale(scaler.get(), frame->data, frame->linesize, 0, h, to, to_stride);
    return out;
  }
};

VideoReader::VideoReader(const std::string& path) : state_(std::make_unique<State>(path)) {}
VideoReader::~VideoReader() = default;

const VideoInfo& VideoReader::info() const {
  return state_->info;
}

std::optional<DecodedFrame> VideoReader::next() {
  if (!state_->decode()) return std::nullopt;
  return state_->take();
}

}  // namespace pinchlab
