// SPDX-License-Identifier: GPL-3.0-or-later
// Writes videos by FFmpeg's libraries.

#include <fmt/format.h>

#include <stdexcept>

#include "base/partial_file.h"
#include "render/canvas.h"
#include "render/libav.h"
#include "render/palette.h"
#include "render/processor_time.h"
#include "render/video.h"
#include "render/yuv.h"

namespace pinchlab {

using libav::check;
using libav::made;
using libav::Owned;

namespace {

/// What differs from codec to codec. Options are FFmpeg's; "g" is the distance of key frames.
struct CodecTraits {
  const char* name;
  const char* ending;
  const char* encoder;
  const char* container;
  AVPixelFormat pixel_format;
  const char* options;  // for stimuli, see describe()
  const char* muxer_options;
};

const CodecTraits& traits(Codec codec) {
  // Stimuli: adaptive quantisation spoils flat areas, so it is off; one encoder thread and x264's
  // plain arithmetic order make the bytes the same on any processor. Kinds of frames follow one
  // another in the same order in every clip (equal_sizes.h). FFV1 has key frames only.
  static constexpr CodecTraits h264{
      "h264",
      ".mp4",
      "libx264",
      "mp4",
      AV_PIX_FMT_YUV420P,
      "preset=veryfast:crf=14:aq-mode=0:b_strategy=0:sc_threshold=0:x264-params=cpu-independent=1",
      libav::mp4_options};
  static constexpr CodecTraits vp9{"vp9",
                                   ".webm",
                                   "libvpx-vp9",
                                   "webm",
                                   AV_PIX_FMT_YUV420P,
                                   "deadline=good:cpu-used=5:crf=16:b=0:row-mt=0:tile-columns=0",
                                   ""};
  static constexpr CodecTraits ffv1{
      "ffv1", ".mkv", "ffv1", "matroska", AV_PIX_FMT_0RGB32, "level=3:slicecrc=1:slices=4:g=1", ""};
  static constexpr CodecTraits apng{"apng",           ".apng",      "apng",   "apng",
                                    AV_PIX_FMT_RGB24, "pred=mixed", "plays=0"};
  static constexpr CodecTraits webp{"webp",  ".webp",          "libwebp_anim",
                                    "webp",  AV_PIX_FMT_RGB32, "lossless=1:compression_level=4",
                                    "loop=0"};
  static constexpr CodecTraits gif{"gif", ".gif", "gif", "gif", AV_PIX_FMT_PAL8, "", "loop=0"};
  switch (codec) {
    case Codec::apng:
      return apng;
    case Codec::webp:
      return webp;
    case Codec::gif:
      return gif;
    case Codec::h264:
      return h264;
    case Codec::vp9:
      return vp9;
    case Codec::ffv1:
      return ffv1;
  }
  throw std::invalid_argument("unknown codec");
}

bool is_rgb(Codec codec) {
  return traits(codec).pixel_format != AV_PIX_FMT_YUV420P;
}

std::string encoder_options(const VideoSettings& settings) {
  if (!settings.encoder_options.empty()) return settings.encoder_options;
  const std::string options = traits(settings.codec).options;
  // A key frame a second: a player can start anywhere without delay.
  return is_rgb(settings.codec) ? options
                                : fmt::format("g={}:{}", settings.frames_per_second, options);
}

/// Options as a dictionary; what FFmpeg did not take afterwards is an error.
class Options {
 public:
  explicit Options(const std::string& text) {
    if (av_dict_parse_string(&dictionary_, text.c_str(), "=", ":", 0) < 0) {
      av_dict_free(&dictionary_);
      throw std::invalid_argument(
          fmt::format("encoder options \"{}\": expected key=value:key=value", text));
    }
  }
  ~Options() { av_dict_free(&dictionary_); }
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;
  AVDictionary** get() { return &dictionary_; }
  void expect_all_taken() const {
    if (const AVDictionaryEntry* left =
            av_dict_get(dictionary_, "", nullptr, AV_DICT_IGNORE_SUFFIX)) {
      throw std::invalid_argument(fmt::format("encoder option \"{}\" is unknown", left->key));
    }
  }

 private:
  AVDictionary* dictionary_ = nullptr;
};

/// RGBA to packed bytes in another order, without loss: `order` says which byte of RGBA comes
/// where, or 3 for `last`.
template <std::size_t Bytes>
void repack(const std::uint8_t* rgba, int width, const PixelRect& part, std::uint8_t* to,
            std::ptrdiff_t stride, const std::array<std::size_t, Bytes>& order, std::uint8_t last) {
  for (int y = part.top; y < part.top + part.height; ++y) {
    const std::uint8_t* from = rgba + (std::ptrdiff_t{y} * width + part.left) * 4;
    std::uint8_t* out = to + y * stride + std::ptrdiff_t{part.left} * static_cast<int>(Bytes);
    for (int x = 0; x < part.width; ++x, from += 4) {
      for (const std::size_t k : order) *out++ = k == 3 ? last : from[k];
    }
  }
}

}  // namespace

const char* to_string(Codec codec) {
  return traits(codec).name;
}

Codec codec_from_string(const std::string& name) {
  for (const Codec codec :
       {Codec::h264, Codec::vp9, Codec::ffv1, Codec::apng, Codec::webp, Codec::gif}) {
    if (name == to_string(codec)) return codec;
  }
  throw std::invalid_argument(
      fmt::format("unknown codec \"{}\": one of h264, vp9, ffv1, apng, webp, gif", name));
}

void check_video(const std::string& path, const VideoSettings& settings) {
  const int w = settings.width, h = settings.height;
  if (w < smallest_frame || h < smallest_frame || w > largest_frame || h > largest_frame) {
    throw std::invalid_argument(
        fmt::format("{}: a video of {} x {} px cannot be made: each side must be {} to {} px", path,
                    w, h, smallest_frame, largest_frame));
  }
  if (needs_even_sides(settings.codec) && (w % 2 != 0 || h % 2 != 0)) {
    throw std::invalid_argument(fmt::format(
        "{}: {} stores colour for 2 x 2 px, so {} x {} px cannot be made: use even sides, or ffv1",
        path, to_string(settings.codec), w, h));
  }
  if (settings.frames_per_second < 1 || settings.frames_per_second > 1000) {
    throw std::invalid_argument(fmt::format("{}: {} frames a second cannot be made: 1 to 1000",
                                            path, settings.frames_per_second));
  }
  if (settings.codec == Codec::gif && 100 % settings.frames_per_second != 0) {
    throw std::invalid_argument(
        fmt::format("{}: a GIF counts hundredths of a second, so it cannot have {} frames in one: "
                    "say --fps 50 (or 25, 20, 10), or use apng or webp",
                    path, settings.frames_per_second));
  }
}

bool needs_even_sides(Codec codec) {
  return !is_rgb(codec);
}

const char* file_ending(Codec codec) {
  return traits(codec).ending;
}

std::string describe(const VideoSettings& settings) {
  const CodecTraits& t = traits(settings.codec);
  const unsigned version = avcodec_version();
  return fmt::format(
      "{} (libavcodec {}.{}.{}) in {}, {}, {}, {} x {} px, {} frames/s, one thread, {}", t.encoder,
      version >> 16, version >> 8 & 0xff, version & 0xff, t.container,
      av_get_pix_fmt_name(t.pixel_format),
      settings.codec == Codec::gif ? "sRGB, 256 colours"
      : is_rgb(settings.codec)     ? "sRGB, lossless"
                                   : "BT.709 limited range",
      settings.width, settings.height, settings.frames_per_second, encoder_options(settings));
}

struct VideoWriter::State {
  VideoSettings settings;
  PixelRect whole{0, 0, settings.width, settings.height};
  PartialFile partial;
  AVFormatContext* format = nullptr;
  AVStream* stream = nullptr;
  Owned<AVCodecContext> codec;
  Owned<AVFrame> frame;
  Owned<AVPacket> packet;
  std::optional<Palette> palette;  // of a GIF, from its first frame
  std::int64_t frames = 0;
  double convert_seconds = 0.0, encode_seconds = 0.0;

  State(const std::string& path, const VideoSettings& settings_)
      : settings(settings_), partial(path) {
    av_log_set_level(AV_LOG_FATAL);  // errors are thrown instead
    try {
      open_encoder();
      open_file();
    } catch (...) {
      close();
      throw;
    }
  }
  ~State() { close(); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void close() {
    if (format == nullptr) return;
    if (format->pb != nullptr) avio_closep(&format->pb);
    avformat_free_context(format);
    format = nullptr;
  }

  void open_encoder() {
    const CodecTraits& t = traits(settings.codec);
    const AVCodec* encoder = avcodec_find_encoder_by_name(t.encoder);
    if (encoder == nullptr) {
      throw std::runtime_error(
          fmt::format("{}: this system's FFmpeg has no encoder {}; Debian's libavcodec59 does",
                      partial.path(), t.encoder));
    }
    check(avformat_alloc_output_context2(&format, nullptr, t.container, partial.name().c_str()),
          partial.path(), "cannot set up the container");
    codec.reset(made(avcodec_alloc_context3(encoder)));
    codec->width = settings.width;
    codec->height = settings.height;
    codec->time_base = {1, settings.frames_per_second};
    codec->framerate = {settings.frames_per_second, 1};
    codec->sample_aspect_ratio = {1, 1};
    codec->pix_fmt = t.pixel_format;
    codec->thread_count = 1;
    codec->flags |= AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT;
    if ((format->oformat->flags & AVFMT_GLOBALHEADER) != 0)
      codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    const bool rgb = is_rgb(settings.codec);
    codec->color_primaries = AVCOL_PRI_BT709;
    codec->color_trc = rgb ? AVCOL_TRC_IEC61966_2_1 : AVCOL_TRC_BT709;
    codec->colorspace = rgb ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
    codec->color_range = rgb ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    if (!rgb) codec->chroma_sample_location = AVCHROMA_LOC_CENTER;
    Options options(encoder_options(settings));
    check(avcodec_open2(codec.get(), encoder, options.get()), partial.path(),
          "cannot start the encoder");
    options.expect_all_taken();

    frame.reset(made(av_frame_alloc()));
    frame->format = codec->pix_fmt;
    frame->width = settings.width;
    frame->height = settings.height;
    check(av_frame_get_buffer(frame.get(), 0), partial.path(), "no memory for a frame");
    packet.reset(made(av_packet_alloc()));
  }

  void open_file() {
    stream = made(avformat_new_stream(format, nullptr));
    stream->time_base = codec->time_base;
    stream->avg_frame_rate = codec->framerate;
    check(avcodec_parameters_from_context(stream->codecpar, codec.get()), partial.path(),
          "cannot describe the stream");
    format->flags |= AVFMT_FLAG_BITEXACT;  // no dates, no random identifiers
    check(avio_open(&format->pb, partial.name().c_str(), AVIO_FLAG_WRITE), partial.path(),
          "cannot be written");
    Options options(traits(settings.codec).muxer_options);
    check(avformat_write_header(format, options.get()), partial.path(), "cannot be written");
  }

  void convert(const std::uint8_t* rgba, std::span<const PixelRect> changed) {
    check(av_frame_make_writable(frame.get()), partial.path(), "no memory for a frame");
    AVFrame& f = *frame;
    if (settings.codec == Codec::gif) {
      if (!palette) palette.emplace(rgba, settings.width, settings.height);
      std::copy_n(palette->argb().data(), 256, reinterpret_cast<std::uint32_t*>(f.data[1]));
    }
    const YuvPlanes planes{f.data[0],     f.data[1],     f.data[2],
                           f.linesize[0], f.linesize[1], f.linesize[2]};
    for (const PixelRect& part : changed) {
      std::uint8_t* const to = f.data[0];
      const std::ptrdiff_t stride = f.linesize[0];
      switch (settings.codec) {
        case Codec::ffv1:
          repack<4>(rgba, settings.width, part, to, stride, {2, 1, 0, 3}, 0);
          break;
        case Codec::webp:
          repack<4>(rgba, settings.width, part, to, stride, {2, 1, 0, 3}, 255);
          break;
        case Codec::apng:
          repack<3>(rgba, settings.width, part, to, stride, {0, 1, 2}, 255);
          break;
        case Codec::gif:
          palette->index(rgba, settings.width, part, to, stride);
          break;
        case Codec::h264:
        case Codec::vp9:
          rgba_to_yuv420(rgba, settings.width, part, planes);
          break;
      }
    }
  }

  /// Sends a frame (null: no more) and writes the packets that come out.
  void encode(const AVFrame* next) {
    check(avcodec_send_frame(codec.get(), next), partial.path(), "the encoder refused a frame");
    for (;;) {
      const int result = avcodec_receive_packet(codec.get(), packet.get());
      if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
      check(result, partial.path(), "the encoder failed");
      packet->stream_index = stream->index;
      packet->duration = 1;
      av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
      check(av_interleaved_write_frame(format, packet.get()), partial.path(), "cannot be written");
    }
  }

  void finish() {
    if (frames == 0)
      throw std::runtime_error(partial.path() + ": a video needs at least one frame");
    encode(nullptr);
    check(av_write_trailer(format), partial.path(), "cannot be completed");
    check(avio_closep(&format->pb), partial.path(), "cannot be completed");
    partial.keep();
  }
};

VideoWriter::VideoWriter(const std::string& path, const VideoSettings& settings) {
  check_video(path, settings);
  state_ = std::make_unique<State>(path, settings);
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const std::uint8_t* rgba) {
  add(rgba, std::span(&state_->whole, 1));
}

void VideoWriter::add(const std::uint8_t* rgba, std::span<const PixelRect> changed) {
  // There is no frame before the first: all of it is new, whatever the caller's canvas has drawn
  // before.
  if (state_->frames == 0) changed = std::span(&state_->whole, 1);
  const double start = processor_seconds();
  state_->convert(rgba, changed);
  const double converted = processor_seconds();
  state_->frame->pts = state_->frames++;
  state_->encode(state_->frame.get());
  state_->convert_seconds = converted - start;
  state_->encode_seconds = processor_seconds() - converted;
}

void VideoWriter::finish() {
  state_->finish();
}

double VideoWriter::convert_seconds() const {
  return state_->convert_seconds;
}
double VideoWriter::encode_seconds() const {
  return state_->encode_seconds;
}

}  // namespace pinchlab
