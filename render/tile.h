// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A small square of a frame and the quads of a mesh that are seen in it, without OpenGL. Most tiles
// lie within shapes or outside of them, and need no look at their pixels.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/lanes.h"
#include "render/mesh.h"
#include "render/pixel_rect.h"
#include "render/text.h"

namespace pinchlab {

constexpr int tile_side = 8;  // px, even

/// Red, green and blue times alpha, of 0 to 255, and alpha of 0 to 1.
using Premultiplied = std::array<float, 4>;

Premultiplied premultiplied(const Colour& colour);

/// A quad as it is drawn, in px.
struct Brush {
  enum class Kind : std::uint8_t { disc, stroke, straight, arc, triangle, text };
  struct Side {         // of a triangle
    float x, y;         // a corner on it
    float right, down;  // across it
    bool positive;      // whether the triangle lies where these point to
  };

  Kind kind = Kind::disc;
  Frame frame;
  float length = 0.0f;                          // of a stroke
  float outer = 0.0f, core = 0.0f;              // half widths with and without the edge
  float radius = 0.0f;                          // of an arc's middle line
  float spacing = 1.0f, half_mark = 0.0f;       // of marks
  float middle_mark = 0.0f, marks_a_px = 0.0f;  // mark spacings, at the middle and along
  Premultiplied edge{}, core_less_edge{}, mark_less_core{};
  std::array<Side, 3> sides{};
  const TextBitmap* text = nullptr;
};

/// `image`: of a label's text.
Brush make_brush(Program program, const Vertex* quad, const Frame& frame, const TextBitmap* image);

/// What a brush does to a tile.
struct Stain {
  const Brush* brush;
  bool whole = false;              ///< all pixels get `colour`; else each its own
  Premultiplied colour{};          ///< of the core, less the edge's, where not whole
  bool ends = true, marks = true;  ///< of a strip's piece: whether some pixels may see them
};

class Tile {
 public:
  /// Draws the brushes from the first on over paper of one colour. `left`, `top`: its first pixel.
  void draw(int left, int top, const Premultiplied& paper, std::span<const Brush* const> brushes);

  /// Writes its pixels that lie within `part` of a frame, RGBA of 8 bits, `width` px a row.
  void store(std::uint8_t* frame, int width, const PixelRect& part) const;

 private:
  static constexpr int groups = tile_side / lane_count;
  using Plane = std::array<std::array<Lanes, groups>, tile_side>;

  void find_stains(std::span<const Brush* const> brushes);
  void blend(const Premultiplied& colour);
  void blend_each(const Stain& stain);
  template <bool marks, typename Shade>
  void blend_each(const Stain& stain, const Shade& shade);

  int left_ = 0, top_ = 0;  // px
  bool flat_ = true;        // all of one colour, colour_; else as in planes_
  Premultiplied colour_{};
  std::array<Plane, 4> planes_{};
  std::vector<Stain> stains_;
};

}  // namespace pinchlab
