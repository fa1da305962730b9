// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/equal_sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "base/partial_file.h"
#include "render/libav.h"

namespace pinchlab {

using libav::check;
using libav::made;
using libav::Owned;

namespace {

// What decoders skip, ITU-T H.264: a NAL unit (7.3.1) of type 6, an SEI message (7.3.2.3.1) with
// user data that nobody has registered (D.1.7): a UUID and then anything. MP4 writes a NAL unit's
// length before it (ISO/IEC 14496-15, 5.3.4.2), and forbids H.264's own filler data (5.3.2).
constexpr std::array<std::uint8_t, 16> padding_uuid = {
    0x7b, 0x1e, 0x5a, 0xc4, 0x93, 0xd2, 0x4f, 0x68, 0xa6, 0x35, 0xe9, 0x2c, 0xb8, 0x71, 0x4d, 0xf3};
constexpr std::size_t length_bytes = 4;
constexpr std::uint8_t sei = 6, user_data_unregistered = 5, stop_bit = 0x80, one_more_255 = 255;
constexpr std::uint8_t padding_byte = 0x55;  // never a start code, so that nothing is escaped

/// Bytes of an SEI NAL unit with its length before it, whose message has `payload` bytes.
constexpr std::size_t message_size(std::size_t payload) {
  const std::size_t header = 1, type = 1, size = payload / 255 + 1, stop = 1;
  return length_bytes + header + type + size + payload + stop;
}
constexpr std::size_t least_message = message_size(padding_uuid.size());

/// The payload of a message of so many bytes; none for the few sizes that no message has.
std::optional<std::size_t> payload_for(std::size_t bytes) {
  if (bytes < least_message) return std::nullopt;
  const std::size_t about = (bytes - message_size(0)) * 255 / 256;
  for (const std::size_t payload : {about, about + 1}) {
    if (message_size(payload) == bytes) return payload;
  }
  return std::nullopt;
}

void append_message(std::size_t payload, std::vector<std::uint8_t>& to) {
  const std::size_t length = message_size(payload) - length_bytes;
  for (unsigned shift = 32; shift > 0; shift -= 8) {
    to.push_back(static_cast<std::uint8_t>(length >> (shift - 8)));
  }
  to.insert(to.end(), {sei, user_data_unregistered});
  to.insert(to.end(), payload / 255, one_more_255);
  to.push_back(static_cast<std::uint8_t>(payload % 255));
  to.insert(to.end(), padding_uuid.begin(), padding_uuid.end());
  to.insert(to.end(), payload - padding_uuid.size(), padding_byte);
  to.push_back(stop_bit);
}

/// The size for frames of these sizes: the largest one, or where they differ the next above that
/// all can be padded to.
std::size_t common_size(const std::vector<std::size_t>& sizes) {
  const auto [least, most] = std::ranges::minmax(sizes);
  if (least == most) return most;
  std::size_t common = most + least_message;
  while (!std::ranges::all_of(
      sizes, [&common](std::size_t size) { return payload_for(common - size).has_value(); })) {
    ++common;
  }
  return common;
}

/// A video's frames as stored.
class Packets {
 public:
  explicit Packets(const std::string& path) : path_(path) {
    check(avformat_open_input(&format_, path.c_str(), nullptr, nullptr), path, "cannot be read");
    if (format_->nb_streams != 1) throw std::runtime_error(path + ": is not a video alone");
  }
  ~Packets() { avformat_close_input(&format_); }
  Packets(const Packets&) = delete;
  Packets& operator=(const Packets&) = delete;

  const AVStream& stream() const { return *format_->streams[0]; }
  const std::string& path() const { return path_; }

  /// False after the last.
  bool next() {
    av_packet_unref(packet_.get());
    const int result = av_read_frame(format_, packet_.get());
    if (result == AVERROR_EOF) return false;
    check(result, path_, "cannot be read");
    return true;
  }
  AVPacket& packet() { return *packet_; }

 private:
  std::string path_;
  AVFormatContext* format_ = nullptr;
  Owned<AVPacket> packet_{made(av_packet_alloc())};
};

/// The same stream in a new file.
class Copy {
 public:
  Copy(const AVStream& from, const std::string& path) : partial_(path) {
    check(avformat_alloc_output_context2(&format_, nullptr, "mp4", partial_.name().c_str()), path,
          "cannot set up the container");
    try {
      AVStream* to = made(avformat_new_stream(format_, nullptr));
      check(avcodec_parameters_copy(to->codecpar, from.codecpar), path,
            "cannot describe the stream");
      to->codecpar->sample_aspect_ratio = from.sample_aspect_ratio;
      to->time_base = from.time_base;
      to->avg_frame_rate = from.avg_frame_rate;
      format_->flags |= AVFMT_FLAG_BITEXACT;
      check(avio_open(&format_->pb, partial_.name().c_str(), AVIO_FLAG_WRITE), path,
            "cannot be written");
      AVDictionary* options = nullptr;
      int result = av_dict_parse_string(&options, libav::mp4_options, "=", ":", 0);
      if (result >= 0) result = avformat_write_header(format_, &options);
      av_dict_free(&options);
      check(result, path, "cannot be written");
    } catch (...) {
      close();
      throw;
    }
  }
  ~Copy() { close(); }
  Copy(const Copy&) = delete;
  Copy& operator=(const Copy&) = delete;

  /// Writes a frame of this size: the packet's, with padding before it.
  void add(const AVPacket& packet, std::size_t size) {
    bytes_.clear();
    const auto own = static_cast<std::size_t>(packet.size);
    if (size > own) append_message(payload_for(size - own).value(), bytes_);
    bytes_.insert(bytes_.end(), packet.data, packet.data + own);
    check(av_new_packet(packet_.get(), static_cast<int>(size)), partial_.path(), "no memory");
    check(av_packet_copy_props(packet_.get(), &packet), partial_.path(), "no memory");
    std::ranges::copy(bytes_, packet_->data);
    packet_->stream_index = 0;
    check(av_write_frame(format_, packet_.get()), partial_.path(), "cannot be written");
    av_packet_unref(packet_.get());
  }

  void finish() {
    check(av_write_trailer(format_), partial_.path(), "cannot be completed");
    check(avio_closep(&format_->pb), partial_.path(), "cannot be completed");
    partial_.keep();
  }

 private:
  void close() {
    if (format_ == nullptr) return;
    if (format_->pb != nullptr) avio_closep(&format_->pb);
    avformat_free_context(format_);
    format_ = nullptr;
  }

  PartialFile partial_;
  AVFormatContext* format_ = nullptr;
  Owned<AVPacket> packet_{made(av_packet_alloc())};
  std::vector<std::uint8_t> bytes_;
};

void pad_frames(const std::vector<std::string>& from, const std::vector<std::string>& to) {
  std::vector<std::unique_ptr<Packets>> videos;
  std::vector<std::unique_ptr<Copy>> copies;
  for (std::size_t i = 0; i < from.size(); ++i) {
    videos.push_back(std::make_unique<Packets>(from[i]));
    copies.push_back(std::make_unique<Copy>(videos[i]->stream(), to[i]));
  }
  for (;;) {
    const auto ended = std::ranges::count_if(videos, [](const auto& v) { return !v->next(); });
    if (ended == std::ssize(videos)) break;
    const AVPacket& first = videos[0]->packet();
    std::vector<std::size_t> sizes;
    for (const auto& video : videos) {
      const AVPacket& packet = video->packet();
      if (ended > 0 || packet.dts != first.dts || packet.pts != first.pts ||
          packet.flags != first.flags) {
        throw std::runtime_error(fmt::format("{}: its frames are not stored in the order of {}",
                                             video->path(), from[0]));
      }
      sizes.push_back(static_cast<std::size_t>(packet.size));
    }
    const std::size_t common = common_size(sizes);
    for (std::size_t i = 0; i < videos.size(); ++i) copies[i]->add(videos[i]->packet(), common);
  }
  for (const auto& copy : copies) copy->finish();
}

/// Matroska's and WebM's own padding, RFC 8794, 11.3.2: identifier, a length of 8 bytes, zeros.
void pad_ends(const std::vector<std::string>& from, const std::vector<std::string>& to) {
  std::uintmax_t most = 0;
  for (const std::string& path : from) most = std::max(most, std::filesystem::file_size(path));
  constexpr std::uintmax_t head = 9;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::uintmax_t zeros = most - std::filesystem::file_size(from[i]);
    PartialFile partial(to[i]);
    std::ofstream out(partial.name(), std::ios::binary);
    std::ifstream in(from[i], std::ios::binary);
    out << in.rdbuf() << '\xEC';
    const std::uint64_t length = zeros | std::uint64_t{1} << (7 * (head - 1));
    for (unsigned shift = 64; shift > 0; shift -= 8) {
      out.put(static_cast<char>(length >> (shift - 8) & 0xff));
    }
    out << std::string(zeros, '\0');
    out.close();
    if (!in || !out) throw partial.error("cannot be written");
    partial.keep();
  }
}

}  // namespace

bool can_have_equal_sizes(Codec codec) {
  return codec == Codec::h264 || codec == Codec::vp9 || codec == Codec::ffv1;
}

void equal_sizes(Codec codec, const std::vector<std::string>& from,
                 const std::vector<std::string>& to) {
  av_log_set_level(AV_LOG_FATAL);  // errors are thrown instead
  if (codec == Codec::h264) {
    pad_frames(from, to);
  } else {
    pad_ends(from, to);
  }
}

}  // namespace pinchlab
