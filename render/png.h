// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Stills and contact sheets.

#include <cstdint>
#include <string>
#include <vector>

#include "render/picture/look.h"

namespace pinchlab {

/// Writes a PNG from RGBA pixels (8 bits each, alpha premultiplied, top row first): RGB where all
/// are opaque, RGBA otherwise. The same pixels give the same bytes. The file appears under its name
/// only when complete. Throws std::runtime_error if it cannot be written, std::invalid_argument for
/// a size below 1.
void write_png(const std::string& path, int width, int height, const std::uint8_t* rgba);

/// One frame of a contact sheet.
struct SheetFrame {
  std::vector<std::uint8_t> rgba;  // width * height * 4
  std::string label;               // shown under it, e.g. "t = 1.25 s"
};

/// Writes frames of one size as a grid, in reading order, each over its label, on the theme's
/// background in its ink; labels are as small as it takes for each to be under its frame alone.
/// `columns` 0: as many as make the sheet about square. Throws as write_png, and
/// std::invalid_argument if there are no frames or one has another size.
void contact_sheet(const std::string& path, int width, int height,
                   const std::vector<SheetFrame>& frames, int columns = 0, const Theme& theme = {});

}  // namespace pinchlab
