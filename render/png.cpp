// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/png.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
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

/// An RGBA image that things are pasted into.
struct Image {
  int width, height;
  std::vector<std::uint8_t> rgba;
  Image(int width_, int height_)
      : width(width_),
        height(height_),
        rgba(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * 4, 255) {}

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

  void paste(const TextBitmap& text, int centre_x, int centre_y) {
    const int left = centre_x - static_cast<int>(text.centre_x),
              top = centre_y - static_cast<int>(text.centre_y);
    for (int y = std::max(0, -top); y < std::min(text.height, height - top); ++y) {
      for (int x = std::max(0, -left); x < std::min(text.width, width - left); ++x) {
        std::uint8_t* const pixel = at(left + x, top + y);
        std::fill_n(pixel, 3, static_cast<std::uint8_t>(255 - text.at(x, y) * 225 / 255));
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
  std::vector<std::uint8_t> rgb(count * 3);
  for (std::size_t i = 0; i < count; ++i) std::copy_n(rgba + 4 * i, 3, rgb.data() + 3 * i);

  PartialFile partial(path);
  std::unique_ptr<std::FILE, FileCloser> file(std::fopen(partial.name().c_str(), "wb"));
  if (!file) throw partial.error("cannot be written");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  if (png_image_write_to_stdio(&image, file.get(), 0, rgb.data(), 0, nullptr) == 0) {
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, image.message));
  }
  if (std::fclose(file.release()) != 0) throw partial.error("cannot be written");
  partial.keep();
}

void contact_sheet(const std::string& path, int width, int height,
                   const std::vector<SheetFrame>& frames, int columns) {
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
  Image sheet(gap + columns * (width + gap), gap + rows * (height + strip));
  for (int i = 0; i < count; ++i) {
    const int left = gap + i % columns * (width + gap), top = gap + i / columns * (height + strip);
    const SheetFrame& frame = frames[static_cast<std::size_t>(i)];
    sheet.paste(frame, width, height, left, top);
    sheet.paste(font.draw(frame.label, text), left + width / 2, top + height + strip / 2);
  }
  write_png(path, sheet.width, sheet.height, sheet.rgba.data());
}

}  // namespace pinchlab
