// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/png.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "base/partial_file.h"
#include "render/text.h"

namespace pinchlab {

namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

using Pixel = std::array<std::uint8_t, 4>;  // RGBA, premultiplied

/// `share` of 255 of a colour, over a pixel.
Pixel over(const Colour& colour, int share, const Pixel& below) {
  const int alpha = colour.alpha * share / 255;
  const auto mixed = [&](int top, int under) {
    return static_cast<std::uint8_t>((top * alpha + under * (255 - alpha) + 127) / 255);
  };
  return {mixed(colour.red, below[0]), mixed(colour.green, below[1]), mixed(colour.blue, below[2]),
          mixed(255, below[3])};
}

/// An RGBA image that things are pasted into.
struct Image {
  int width, height;
  std::vector<std::uint8_t> rgba;
  Image(int width_, int height_, const Colour& paper)
      : width(width_),
        height(height_),
        rgba(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * 4) {
    const Pixel pixel = over(paper, 255, {});
    for (std::size_t i = 0; i < rgba.size(); ++i) rgba[i] = pixel[i % pixel.size()];
  }

  std::uint8_t* at(int x, int y) {
    return rgba.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(x)) *
                             4;
  }

  void paste(const SheetFrame& frame, int frame_width, int frame_height, int left, int top) {
    const std::size_t row = static_cast<std::size_t>(frame_width) * 4;
    for (int y = 0; y < frame_height; ++y) {
      std::copy_n(frame.rgba.data() + static_cast<std::size_t>(y) * row, row, at(left, top + y));
    }
  }

  void paste(const TextBitmap& text, int centre_x, int centre_y, const Colour& ink) {
    const int left = centre_x - static_cast<int>(text.centre_x),
              top = centre_y - static_cast<int>(text.centre_y);
    for (int y = std::max(0, -top); y < std::min(text.height, height - top); ++y) {
      for (int x = std::max(0, -left); x < std::min(text.width, width - left); ++x) {
        std::uint8_t* const pixel = at(left + x, top + y);
        const Pixel mixed = over(ink, text.at(x, y), {pixel[0], pixel[1], pixel[2], pixel[3]});
        std::ranges::copy(mixed, pixel);
      }
    }
  }
};

}  // namespace

void write_png(const std::string& path, int width, int height, const std::uint8_t* rgba) {
  if (width < 1 || height < 1) {
    throw std::invalid_argument(fmt::format("{}: {} x {} px is no image", path, width, height));
  }
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  bool opaque = true;
  for (std::size_t i = 0; i < count && opaque; ++i) opaque = rgba[4 * i + 3] == 255;
  const std::size_t channels = opaque ? 3 : 4;
  std::vector<std::uint8_t> stored(count * channels);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* const from = rgba + 4 * i;
    std::uint8_t* const to = stored.data() + channels * i;
    std::copy_n(from, channels, to);
    if (opaque || from[3] == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {  // PNG's alpha is not premultiplied
      to[k] = static_cast<std::uint8_t>(std::min(255, (from[k] * 255 + from[3] / 2) / from[3]));
    }
  }

  PartialFile partial(path);
  std::unique_ptr<std::FILE, FileCloser> file(std::fopen(partial.name().c_str(), "wb"));
  if (!file) throw partial.error("cannot be written");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  errno = 0;
  if (png_image_write_to_stdio(&image, file.get(), 0, stored.data(), 0, nullptr) == 0) {
    if (errno != 0)
      throw partial.error("cannot be written");  // the disk's reason, not "Write Error"
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, image.message));
  }
  if (std::fclose(file.release()) != 0) throw partial.error("cannot be written");
  partial.keep();
}

void contact_sheet(const std::string& path, int width, int height,
                   const std::vector<SheetFrame>& frames, int columns, const Theme& theme) {
  if (frames.empty())
    throw std::invalid_argument(path + ": a contact sheet needs at least one frame");
  const std::size_t bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  for (const SheetFrame& frame : frames) {
    if (width < 1 || height < 1 || frame.rgba.size() != bytes) {
      throw std::invalid_argument(
          fmt::format("{}: frame \"{}\" is not {} x {} px", path, frame.label, width, height));
    }
  }
  const int count = static_cast<int>(frames.size());
  if (columns <= 0)
    columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count) * height / width)));
  columns = std::min(columns, count);
  const int rows = (count + columns - 1) / columns;

  const Font font;
  const int gap = std::max(4, width / 60), text = std::max(12, width / 24), strip = 2 * text;
  Image sheet(gap + columns * (width + gap), gap + rows * (height + strip), theme.background);
  std::vector<std::string> labels;
  for (const SheetFrame& frame : frames) labels.push_back(frame.label);
  const double em = font.fitting(labels, text, width);
  for (int i = 0; i < count; ++i) {
    const int left = gap + i % columns * (width + gap), top = gap + i / columns * (height + strip);
    const SheetFrame& frame = frames[static_cast<std::size_t>(i)];
    sheet.paste(frame, width, height, left, top);
    sheet.paste(font.draw(frame.label, em), left + width / 2, top + height + strip / 2, theme.ink);
  }
  write_png(path, sheet.width, sheet.height, sheet.rgba.data());
}

}  // namespace pinchlab
