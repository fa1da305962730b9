// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Meshes to pixels, in one of two ways.

#include <cstdint>
#include <memory>
#include <vector>

#include "render/mesh.h"
#include "render/pixel_rect.h"
#include "render/text.h"

namespace pinchlab {

class Painter {
 public:
  virtual ~Painter() = default;

  /// Keeps the image of a label's text; what LabelImage::texture is for it, never 0.
  virtual std::uint32_t keep(TextBitmap image) = 0;
  /// Forgets all images.
  virtual void forget_images() = 0;

  /// Draws the mesh anew in the parts of the frame that have changed, into `pixels` (RGBA of 8
  /// bits, top row first). `first`: with these sheets, so that pages have not been seen before.
  virtual void paint(const Mesh& mesh, const std::vector<PixelRect>& changed, bool first,
                     std::uint8_t* pixels) = 0;

  /// What a rectangle costs, in px of drawing, beside its pixels: fewer and larger ones may do.
  virtual int rectangle_cost() const = 0;
};

/// Tile by tile (tile.h), without a driver: the same bytes on every processor.
std::unique_ptr<Painter> make_tile_painter(int width, int height);

/// By OpenGL's programs (gl.h): another way to the same picture, which tests compare.
std::unique_ptr<Painter> make_gl_painter(int width, int height);

/// The tile painter; OpenGL's where the environment variable PINCHLAB_GL names one (gl_context.h).
std::unique_ptr<Painter> make_painter(int width, int height);

}  // namespace pinchlab
