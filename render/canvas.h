// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pictures to pixels, off-screen, with analytic anti-aliasing.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/picture/picture.h"
#include "render/pixel_rect.h"

namespace pinchlab {

constexpr int smallest_frame = 16;   // px
constexpr int largest_frame = 8192;  // px

/// Draws pictures into a frame of its own. The same picture gives the same bytes in every run on
/// any machine.
///
/// Where the environment variable PINCHLAB_GL asks for OpenGL, its driver draws instead
/// (gl_context.h): bytes that differ by a level or two, and one canvas at a time in a process.
class Canvas {
 public:
  /// Throws std::runtime_error if the size is not within smallest_frame..largest_frame, or where
  /// OpenGL is asked for and cannot be had.
  Canvas(int width, int height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  int width() const;
  int height() const;

  /// RGBA, 8 bits each, alpha premultiplied (opaque where the background is), top row first, width
  /// * 4 bytes a row; valid until the next draw. Throws std::runtime_error if the font is missing
  /// or OpenGL reports an error.
  const std::uint8_t* draw(const Picture& picture);

  /// The same for several pictures side by side, left to right, each in an equal share of the
  /// width.
  const std::uint8_t* draw(std::span<const Picture* const> pictures);

  /// Where the last draw's frame may differ from the one before (the whole of it at first):
  /// rectangles that overlap nowhere, with even sides and places if the frame's sides are even. See
  /// VideoWriter::add.
  const std::vector<PixelRect>& changed() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pinchlab
