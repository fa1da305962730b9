// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Anti-aliased text as coverage bitmaps.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pinchlab {

/// A line of text. Its visual centre (half the height of a capital above the base line, half the
/// advance width) is `centre_x`, `centre_y` px from the top left corner.
struct TextBitmap {
  int width = 0, height = 0;  // px, with a margin of one
  double centre_x = 0.0, centre_y = 0.0;
  std::vector<std::uint8_t> coverage;  // width * height, top row first, 255 = inside

  std::uint8_t& at(int x, int y) { return coverage[index(x, y)]; }
  std::uint8_t at(int x, int y) const { return coverage[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// Where the font of labels is. Throws std::runtime_error as Font does.
std::string font_file();

/// DejaVu Sans.
class Font {
 public:
  /// Throws std::runtime_error that says where it looked and which package to install. The
  /// environment variable PINCHLAB_FONT names another font file.
  Font();
  ~Font();
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  /// UTF-8 text with an em of `height` px, limited to 1..1000. What is not UTF-8 shows as a
  /// question mark.
  TextBitmap draw(const std::string& text, double height) const;

  /// The em, px, at which none of the texts is wider than `width` px; `height` at most.
  double fitting(const std::vector<std::string>& texts, double height, double width) const;

  /// The characters of a text that the font has no letter for: in their place it shows a box.
  std::string lacking(const std::string& text) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pinchlab
