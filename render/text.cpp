// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/text.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace pinchlab {

namespace {

/// The next character of UTF-8 text from `i` on, which moves behind it; '?' for what is not UTF-8.
char32_t next_character(const std::string& text, std::size_t& i) {
  const auto lead = static_cast<unsigned char>(text[i++]);
  if (lead < 0x80) return lead;
  const int more = lead >= 0xf0 && lead < 0xf8   ? 3
                   : lead >= 0xe0 && lead < 0xf0 ? 2
                   : lead >= 0xc0 && lead < 0xe0 ? 1
                                                 : 0;
  if (more == 0) return U'?';
  char32_t code = lead & (0x3fu >> more);
  for (int k = 0; k < more; ++k) {
    if (i >= text.size() || (static_cast<unsigned char>(text[i]) & 0xc0u) != 0x80u) return U'?';
    code = code << 6 | (static_cast<unsigned char>(text[i++]) & 0x3fu);
  }
  return code;
}

}  // namespace

std::string font_file() {
  if (const char* chosen = std::getenv("PINCHLAB_FONT")) {
    if (std::filesystem::exists(chosen)) return chosen;
    throw std::runtime_error(std::string("PINCHLAB_FONT names a file that does not exist: ") +
                             chosen);
  }
  std::string tried;
  for (const char* place : {PINCHLAB_FONT_FILE, "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                            "/usr/share/fonts/TTF/DejaVuSans.ttf",
                            "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf"}) {
    if (std::filesystem::exists(place)) return place;
    tried += std::string(tried.empty() ? "" : ", ") + place;
  }
  throw std::runtime_error(
      "no font for labels (looked for " + tried +
      "): install Debian's fonts-dejavu-core, or let PINCHLAB_FONT name a font file");
}

struct Font::State {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  ~State() {
    if (face != nullptr) FT_Done_Face(face);
    if (library != nullptr) FT_Done_FreeType(library);
  }
};

Font::Font() : state_(std::make_unique<State>()) {
  const std::string file = font_file();
  if (FT_Init_FreeType(&state_->library) != 0) throw std::runtime_error("FreeType does not start");
  if (FT_New_Face(state_->library, file.c_str(), 0, &state_->face) != 0 ||
      FT_IS_SCALABLE(state_->face) == 0) {
    throw std::runtime_error(file + ": not a scalable font that FreeType can read");
  }
}

Font::~Font() = default;

TextBitmap Font::draw(const std::string& text, double height) const {
  const FT_Face face = state_->face;
  const double em = std::clamp(height, 1.0, 1000.0);
  FT_Set_Char_Size(face, 0, std::lround(64.0 * em), 72, 72);

  // Without hinting a label has the same shape at every size and place.
  constexpr FT_Int32 flags = FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP;
  std::vector<FT_UInt> glyphs;
  FT_Pos advance = 0;  // 1/64 px
  for (std::size_t i = 0; i < text.size();) {
    glyphs.push_back(FT_Get_Char_Index(face, next_character(text, i)));
    if (FT_Load_Glyph(face, glyphs.back(), flags) == 0) advance += face->glyph->advance.x;
  }

  const double capital =  // px, its height above the base line
      FT_Load_Char(face, 'H', flags) == 0
          ? static_cast<double>(face->glyph->metrics.horiBearingY) / 64.0
          : 0.7 * em;
  const int base = 2 + static_cast<int>(std::ceil(em));
  const int side = 1 + static_cast<int>(std::ceil(0.2 * em));
  TextBitmap bitmap;
  bitmap.width = 2 * side + static_cast<int>(advance / 64 + 1);
  bitmap.height = base + 2 + static_cast<int>(std::ceil(0.4 * em));
  bitmap.centre_x = side + static_cast<double>(advance) / 128.0;
  bitmap.centre_y = base - 0.5 * capital;
  bitmap.coverage.assign(
      static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height), 0);

  FT_Pos pen = FT_Pos{64} * side;
  for (const FT_UInt glyph : glyphs) {
    if (FT_Load_Glyph(face, glyph, flags) != 0) continue;
    const FT_GlyphSlot slot = face->glyph;
    FT_Outline_Translate(&slot->outline, pen & 63, 0);
    if (FT_Render_Glyph(slot, FT_RENDER_MODE_NORMAL) != 0) continue;
    const int left = static_cast<int>(pen >> 6) + slot->bitmap_left, top = base - slot->bitmap_top;
    for (int y = 0; y < static_cast<int>(slot->bitmap.rows); ++y) {
      for (int x = 0; x < static_cast<int>(slot->bitmap.width); ++x) {
        const int to_x = left + x, to_y = top + y;
        if (to_x < 0 || to_y < 0 || to_x >= bitmap.width || to_y >= bitmap.height) continue;
        const int both = bitmap.at(to_x, to_y) + slot->bitmap.buffer[y * slot->bitmap.pitch + x];
        bitmap.at(to_x, to_y) = static_cast<std::uint8_t>(std::min(both, 255));
      }
    }
    pen += slot->advance.x;
  }
  return bitmap;
}

double Font::fitting(const std::vector<std::string>& texts, double height, double width) const {
  double em = height;
  for (const std::string& text : texts)
    em = std::min(em, height * width / draw(text, height).width);
  return em;
}

std::string Font::lacking(const std::string& text) const {
  std::string characters;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t begin = i;
    const char32_t character = next_character(text, i);
    if (FT_Get_Char_Index(state_->face, character) == 0)
      characters += text.substr(begin, i - begin);
  }
  return characters;
}

}  // namespace pinchlab
