// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pictures as vector graphics, for papers: the same shapes as a canvas draws.

#include <string>
#include <vector>

#include "render/picture/look.h"

namespace pinchlab {

enum class VectorFormat { svg, pdf };

/// One picture, and what stands under it on a sheet.
struct VectorFrame {
  Picture picture;
  std::string label;
};

/// Writes one picture of `width` x `height` (1/72 inch in PDF, px in SVG), or several as a grid
/// with their labels, laid out and coloured as contact_sheet does. A background of alpha 0 is left
/// out. Text stays text. The same frames give the same bytes. The file appears under its name only
/// when complete. Throws std::runtime_error if it cannot be written, std::invalid_argument if there
/// are no frames.
void write_vector(const std::string& path, VectorFormat format, int width, int height,
                  const std::vector<VectorFrame>& frames, int columns = 0, const Theme& theme = {});

}  // namespace pinchlab
