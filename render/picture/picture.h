// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a frame shows: a list of shapes in world metres, free of pixels, fonts and GL. A canvas fits
// `view` into its frame; everything, text and line widths included, scales with it.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/scene.h"

namespace pinchlab {

/// Colour as stored in the frame (sRGB, alpha not premultiplied).
struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0, alpha = 255;
  bool operator==(const Colour&) const = default;
};

/// All points within `half_width` of the line from a to b: a thick line with round ends, or a disc
/// where a = b. Its outermost `edge_width` has the colour `edge`, the rest `fill`; a ring has a
/// fill of alpha 0.
struct Stroke {
  Vec2 a = Vec2::Zero(), b = Vec2::Zero();  // m
  double half_width = 0.0;                  // m
  double edge_width = 0.0;                  // m
  Colour fill, edge;
};

/// A point of a band's centre line.
struct StripPoint {
  Vec2 position = Vec2::Zero();   // m
  Vec2 tangent = Vec2(1.0, 0.0);  // unit
  double material = 0.0;          // m along the material
};

constexpr double most_turn = 0.5;  ///< rad, between neighbouring points of a strip

/// A band of constant width along points[first .. first + count), with flat ends. Two points are
/// joined by the circular arc that turns by the angle between their tangents (most_turn at most:
/// longer arcs take more points), or by a line; where they coincide, by a round joint. The material
/// coordinates carry marks: bands of `mark_length` m of the material, centred on the multiples of
/// `mark_spacing`.
struct Strip {
  std::size_t first = 0, count = 0;  // into Picture::points
  double half_width = 0.0;           // m
  double edge_width = 0.0;           // m
  double mark_spacing = 1.0;         // m of material, > 0
  double mark_length = 0.0;          // m of material; 0: no marks
  Colour fill, edge, mark;
};

/// A convex polygon of corners[first .. first + count), without antialiasing: its sides are to lie
/// under other shapes of the same colour, or of one that hides them.
struct Patch {
  std::size_t first = 0, count = 0;  // into Picture::corners
  Colour fill;
};

/// One line of text, centred on a point.
struct Label {
  Vec2 centre = Vec2::Zero();  // m
  double height = 0.1;         // m, font size (the em)
  std::string text;            // UTF-8
  Colour colour;
};

/// The shapes in painter's order: later ones lie on top.
struct Picture {
  enum class Kind : std::uint8_t { stroke, strip, patch, label };
  struct Item {
    Kind kind;
    std::size_t index;  // into strokes, strips, patches or labels
  };

  View view;  // m, fitted into the frame and centred, aspect kept
  Colour background{255, 255, 255, 255};
  std::vector<Stroke> strokes;
  std::vector<StripPoint> points;
  std::vector<Strip> strips;
  std::vector<Vec2> corners;  // m
  std::vector<Patch> patches;
  std::vector<Label> labels;
  std::vector<Item> order;

  void add(const Stroke& stroke) {
    order.push_back({Kind::stroke, strokes.size()});
    strokes.push_back(stroke);
  }
  void add(const Strip& strip) {
    order.push_back({Kind::strip, strips.size()});
    strips.push_back(strip);
  }
  void add(const Patch& patch) {
    order.push_back({Kind::patch, patches.size()});
    patches.push_back(patch);
  }
  void add(Label label) {
    order.push_back({Kind::label, labels.size()});
    labels.push_back(std::move(label));
  }
  /// Empties the lists but keeps their storage, so that a clip's frames need no new memory.
  void clear() {
    strokes.clear();
    points.clear();
    strips.clear();
    corners.clear();
    patches.clear();
    labels.clear();
    order.clear();
  }
};

}  // namespace pinchlab
