// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/tile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace pinchlab {

namespace {

// From a tile's middle to its outermost pixels' middles, px, with room for rounding.
constexpr float slack = 0.05f;
constexpr float half_side = 0.5f * (tile_side - 1) + slack;
constexpr float half_diagonal = 0.70710678f * (tile_side - 1) + slack;

template <typename Value>
Value number(float value) {
  return Value{} + value;
}

/// Where a point is with respect to a shape's middle line, px.
template <typename Value>
struct Place {
  Value distance, along;
};

template <Brush::Kind kind, typename Value>
Place<Value> place(const Brush& b, Value x, Value y) {
  const Value right = x - b.frame.origin[0], down = y - b.frame.origin[1];
  if constexpr (kind == Brush::Kind::disc) {
    return {square_root(right * right + down * down), Value{}};
  } else {
    const Value px = right * b.frame.x_axis[0] + down * b.frame.x_axis[1];
    const Value py = right * b.frame.y_axis[0] + down * b.frame.y_axis[1];
    if constexpr (kind == Brush::Kind::stroke) {
      const Value beyond = px - least(most(px, Value{}), number<Value>(b.length));
      return {square_root(beyond * beyond + py * py), px};
    } else if constexpr (kind == Brush::Kind::straight) {
      return {magnitude(px), py};
    } else {
      // |q| - r, for q from the arc's centre, is (q^2 - r^2) / (|q| + r). With c from the centre to
      // the chord's middle and h half the chord, r^2 = c^2 + h^2: a large r costs no digits.
      const float c = b.frame.centre, h = b.frame.half_chord;
      const Value outwards = px + c, square = py * py;
      const Value from_centre = square_root(outwards * outwards + square);
      const Value off = (px * (px + 2.0f * c) + (square - h * h)) / (from_centre + b.radius);
      // Pieces turn little, so a few terms of the arc tangent's series do.
      const Value u = py / most(outwards, number<Value>(1e-3f)), q = u * u;
      return {magnitude(off), b.radius * u * (1.0f + q * (0.2f * q - 1.0f / 3.0f))};
    }
  }
}

/// The share of a pixel `distance` px from the middle of a band that the band covers: that of a
/// pixel 1 px wide across it, right for bands thinner than a pixel too.
Lanes coverage(Lanes distance, float half_width) {
  const float full = std::min(2.0f * half_width, 1.0f);
  return least(most((half_width + 0.5f) - distance, Lanes{}), splat(full));
}

/// px from the nearest mark's middle, of material at m mark spacings.
Lanes from_mark(const Brush& b, Lanes m) {
  return b.spacing * magnitude(m - floor_of(m + 0.5f));
}

/// px behind the beginning of a strip's piece, and behind its end.
template <typename Value>
Value behind(const std::array<float, 2>& point, const std::array<float, 2>& along, Value x,
             Value y) {
  return (x - point[0]) * along[0] + (y - point[1]) * along[1];
}

/// By how much that may differ between a tile's middle and its pixels.
float spread_of(const std::array<float, 2>& across) {
  return half_side * (std::abs(across[0]) + std::abs(across[1]));
}

Premultiplied sum(const Premultiplied& a, const Premultiplied& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]};
}

enum class Cover {
  none,
  whole,  // all pixels get the same colour
  part
};

/// Of a band whose middle line is `distance` px from the tile's middle.
Cover band_cover(const Brush& b, float distance, Stain& stain) {
  const float nearest = distance - half_diagonal, furthest = distance + half_diagonal;
  if (nearest >= b.outer + 0.5f) return Cover::none;
  if (b.core >= 0.5f && furthest <= b.core - 0.5f) {
    stain.colour = sum(b.edge, stain.colour);
    return Cover::whole;
  }
  if (b.outer >= 0.5f && furthest <= b.outer - 0.5f && nearest >= b.core + 0.5f) {
    stain.colour = b.edge;
    return Cover::whole;
  }
  return Cover::part;
}

/// Whether a tile shows marks or what lies between them, and not both.
void find_marks(const Brush& b, float along, Stain& stain) {
  stain.marks = false;
  if (b.half_mark == 0.0f) return;
  // Inside of an arc's middle line the marks lie closer.
  const float inner = b.radius - b.outer - 0.5f;
  const float closer = b.radius == 0.0f ? 1.0f : b.radius / most(inner, 1e-3f);
  const float m = b.middle_mark + b.marks_a_px * along;
  const float beyond = b.spacing * std::abs(m - std::round(m)) - b.half_mark;
  const float room = 0.5f + half_diagonal * closer * std::abs(b.marks_a_px) * b.spacing;
  stain.marks = std::abs(beyond) < room || b.half_mark < 0.5f;
  if (!stain.marks && beyond < 0.0f) stain.colour = sum(stain.colour, b.mark_less_core);
}

template <Brush::Kind kind>
Cover piece_cover(const Brush& b, float x, float y, Stain& stain) {
  const Frame& f = b.frame;
  const float from = behind(f.from, f.from_along, x, y), to = behind(f.to, f.to_along, x, y);
  if (from < -half_diagonal || to > half_diagonal) return Cover::none;
  stain.ends = from < half_diagonal || to > -half_diagonal;
  const Place<float> at = place<kind>(b, x, y);
  find_marks(b, at.along, stain);
  Stain within = stain;
  const Cover cover = band_cover(b, at.distance, within);
  const bool in_core = at.distance < b.core;
  if (cover == Cover::whole && (stain.ends || (stain.marks && in_core))) return Cover::part;
  stain = within;
  return cover;
}

Cover triangle_cover(const Brush& b, float x, float y, Stain& stain) {
  Cover cover = Cover::whole;
  for (const Brush::Side& side : b.sides) {
    const float across = side.right * (x - side.x) + side.down * (y - side.y);
    const float inside = side.positive ? across : -across;
    const float spread = spread_of({side.right, side.down});
    if (inside < -spread) return Cover::none;
    if (inside < spread) cover = Cover::part;
  }
  if (cover == Cover::whole) stain.colour = sum(b.edge, stain.colour);
  return cover;
}

/// `x`, `y`: the tile's middle.
Cover cover_of(const Brush& b, float x, float y, Stain& stain) {
  using enum Brush::Kind;
  switch (b.kind) {
    case disc:
      return band_cover(b, place<disc>(b, x, y).distance, stain);
    case stroke:
      return band_cover(b, place<stroke>(b, x, y).distance, stain);
    case straight:
      return piece_cover<straight>(b, x, y, stain);
    case arc:
      return piece_cover<arc>(b, x, y, stain);
    case triangle:
      return triangle_cover(b, x, y, stain);
    case text:
      return Cover::part;
  }
  return Cover::none;
}

/// Shares of pixels that have a shape's edge or core, the core alone, and of the core a mark.
struct Shares {
  Lanes outer, core, mark;
};

template <Brush::Kind kind>
Shares round_shares(const Brush& b, Lanes x, Lanes y) {
  const Lanes distance = place<kind>(b, x, y).distance;
  return {coverage(distance, b.outer), coverage(distance, b.core), Lanes{}};
}

template <Brush::Kind kind, bool ends, bool marks>
Shares piece_shares(const Brush& b, Lanes x, Lanes y) {
  const Place<Lanes> at = place<kind>(b, x, y);
  Shares found{coverage(at.distance, b.outer), coverage(at.distance, b.core), Lanes{}};
  if constexpr (ends) {
    const Frame& f = b.frame;
    const Mask within =
        (behind(f.from, f.from_along, x, y) >= 0.0f) & (behind(f.to, f.to_along, x, y) < 0.0f);
    found.outer = only(within, found.outer);
    found.core = only(within, found.core);
  }
  if constexpr (marks) {
    found.mark = coverage(from_mark(b, b.middle_mark + b.marks_a_px * at.along), b.half_mark);
  }
  return found;
}

Shares triangle_shares(const Brush& b, Lanes x, Lanes y) {
  Mask within = Lanes{} == 0.0f;
  for (const Brush::Side& side : b.sides) {
    const Lanes across = side.right * (x - side.x) + side.down * (y - side.y);
    within &= side.positive ? across >= 0.0f : across < 0.0f;
  }
  const Lanes share = only(within, splat(1.0f));
  return {share, share, Lanes{}};
}

/// A text's image, moved by less than a pixel to where the label is.
class Print {
 public:
  explicit Print(const Brush& b)
      : text_(*b.text),
        left_(static_cast<int>(std::floor(b.frame.origin[0]))),
        top_(static_cast<int>(std::floor(b.frame.origin[1]))),
        right_(b.frame.origin[0] - std::floor(b.frame.origin[0])),
        down_(b.frame.origin[1] - std::floor(b.frame.origin[1])) {}

  Shares at(int x, int y) const {
    Lanes share{};
    for (int i = 0; i < lane_count; ++i) {
      const float here = row(x + i - left_, y - top_), before = row(x + i - 1 - left_, y - top_);
      share[i] = (here + right_ * (before - here)) / 255.0f;
    }
    return {share, share, Lanes{}};
  }

 private:
  float row(int x, int y) const {
    const float here = texel(x, y), above = texel(x, y - 1);
    return here + down_ * (above - here);
  }
  float texel(int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < text_.width && y < text_.height;
    return inside ? static_cast<float>(text_.at(x, y)) : 0.0f;
  }

  const TextBitmap& text_;
  int left_, top_;      // px
  float right_, down_;  // of a px
};

/// Pixels as RGBA of 8 bits, by their channels.
template <typename Channel>
Mask packed(const Channel& channel) {
  const auto level = [](Lanes value) { return __builtin_convertvector(value + 0.5f, Mask); };
  return level(channel(0)) | level(channel(1)) << 8 | level(channel(2)) << 16 |
         level(channel(3) * 255.0f) << 24;
}

using Corner = std::array<float, 2>;

/// Neighbouring triangles have the same numbers for the side between them, so that each pixel is
/// within one of them.
Brush::Side side_between(Corner a, Corner b, const Corner& other) {
  if (b < a) std::swap(a, b);
  Brush::Side side{a[0], a[1], a[1] - b[1], b[0] - a[0], false};
  side.positive = side.right * (other[0] - side.x) + side.down * (other[1] - side.y) >= 0.0f;
  return side;
}

}  // namespace

Premultiplied premultiplied(const Colour& colour) {
  const float alpha = static_cast<float>(colour.alpha) / 255.0f;
  return {alpha * static_cast<float>(colour.red), alpha * static_cast<float>(colour.green),
          alpha * static_cast<float>(colour.blue), alpha};
}

Brush make_brush(Program program, const Vertex* quad, const Frame& frame, const TextBitmap* image) {
  using enum Brush::Kind;
  Brush b;
  b.frame = frame;
  const Premultiplied fill = premultiplied(quad->fill), mark = premultiplied(quad->mark);
  b.edge = premultiplied(quad->edge);
  for (std::size_t k = 0; k < fill.size(); ++k) {
    b.core_less_edge[k] = fill[k] - b.edge[k];
    b.mark_less_core[k] = mark[k] - fill[k];
  }
  const auto& shape = quad->shape;
  if (program == Program::label) {
    b.kind = text;
    b.text = image;
  } else if (program == Program::strip) {
    b.radius = quad->curve[0];
    b.kind = b.radius > 0.0f ? arc : straight;
    b.outer = shape[0];
    b.core = shape[1];
    b.spacing = shape[2];
    b.half_mark = shape[3];
    b.middle_mark = quad->curve[1];
    b.marks_a_px = quad->curve[2];
  } else if (frame == Frame{}) {
    b.kind = triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      b.sides[k] =
          side_between(quad[k].position, quad[(k + 1) % 3].position, quad[(k + 2) % 3].position);
    }
  } else {
    b.length = shape[0];
    b.kind = b.length == 0.0f ? disc : stroke;
    b.outer = shape[1];
    b.core = shape[2];
  }
  return b;
}

void Tile::draw(int left, int top, const Premultiplied& paper,
                std::span<const Brush* const> brushes) {
  left_ = left;
  top_ = top;
  flat_ = true;
  colour_ = paper;
  find_stains(brushes);
  // What lies under an opaque colour is not seen.
  auto first = std::find_if(stains_.rbegin(), stains_.rend(), [](const Stain& stain) {
                 return stain.whole && stain.colour[3] == 1.0f;
               }).base();
  if (first != stains_.begin()) --first;
  for (; first != stains_.end(); ++first) {
    if (first->whole) {
      blend(first->colour);
    } else {
      blend_each(*first);
    }
  }
}

void Tile::find_stains(std::span<const Brush* const> brushes) {
  stains_.clear();
  const float x = static_cast<float>(left_) + 0.5f * tile_side;
  const float y = static_cast<float>(top_) + 0.5f * tile_side;
  for (const Brush* brush : brushes) {
    Stain stain{brush, false, brush->core_less_edge};
    const Cover cover = cover_of(*brush, x, y, stain);
    if (cover == Cover::none) continue;
    stain.whole = cover == Cover::whole;
    stains_.push_back(stain);
  }
}

void Tile::blend(const Premultiplied& colour) {
  const float through = 1.0f - colour[3];
  if (flat_) {
    for (std::size_t k = 0; k < colour.size(); ++k) colour_[k] = colour[k] + through * colour_[k];
    return;
  }
  for (std::size_t k = 0; k < colour.size(); ++k) {
    for (auto& row : planes_[k]) {
      for (Lanes& pixels : row) pixels = colour[k] + through * pixels;
    }
  }
}

template <bool marks, typename Shade>
void Tile::blend_each(const Stain& stain, const Shade& shade) {
  const Brush b = *stain.brush;  // copies, which no pixel's writing can change
  const Premultiplied core = stain.colour;
  for (std::size_t row = 0; row < tile_side; ++row) {
    for (std::size_t group = 0; group < groups; ++group) {
      const Shares s = shade(b, static_cast<int>(group) * lane_count, static_cast<int>(row));
      if (!any(s.outer > 0.0f)) continue;
      const auto mixed = [&](std::size_t k) {
        if constexpr (!marks) return b.edge[k] * s.outer + core[k] * s.core;
        return b.edge[k] * s.outer + (core[k] + b.mark_less_core[k] * s.mark) * s.core;
      };
      const Lanes through = 1.0f - mixed(3);
      for (std::size_t k = 0; k < planes_.size(); ++k) {
        Lanes& pixels = planes_[k][row][group];
        pixels = mixed(k) + through * pixels;
      }
    }
  }
}

void Tile::blend_each(const Stain& stain) {
  using enum Brush::Kind;
  if (flat_) {
    flat_ = false;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      for (auto& row : planes_[k]) row.fill(splat(colour_[k]));
    }
  }
  const Lanes left = static_cast<float>(left_) + Lanes{0.5f, 1.5f, 2.5f, 3.5f};
  const float top = static_cast<float>(top_) + 0.5f;
  const auto each = [&]<bool marks = false>(const auto& shares) {
    blend_each<marks>(stain, [&shares, left, top](const Brush& b, int column, int row) {
      return shares(b, left + static_cast<float>(column), splat(top + static_cast<float>(row)));
    });
  };
  const auto piece = [&]<Brush::Kind kind>() {
    const auto with = [&]<bool ends, bool marks>() {
      each.template operator()<marks>([](const Brush& b, Lanes x, Lanes y) {
        return piece_shares<kind, ends, marks>(b, x, y);
      });
    };
    if (stain.ends && stain.marks) return with.template operator()<true, true>();
    if (stain.ends) return with.template operator()<true, false>();
    if (stain.marks) return with.template operator()<false, true>();
    return with.template operator()<false, false>();
  };
  switch (stain.brush->kind) {
    case disc:
      return each([](const Brush& b, Lanes x, Lanes y) { return round_shares<disc>(b, x, y); });
    case stroke:
      return each([](const Brush& b, Lanes x, Lanes y) { return round_shares<stroke>(b, x, y); });
    case straight:
      return piece.template operator()<straight>();
    case arc:
      return piece.template operator()<arc>();
    case triangle:
      return each([](const Brush& b, Lanes x, Lanes y) { return triangle_shares(b, x, y); });
    case text: {
      const Print print(*stain.brush);
      return blend_each<false>(stain, [this, &print](const Brush&, int column, int row) {
        return print.at(left_ + column, top_ + row);
      });
    }
  }
}

static_assert(std::endian::native == std::endian::little, "packed() puts red first");

void Tile::store(std::uint8_t* frame, int width, const PixelRect& part) const {
  const int left = std::max(left_, part.left), top = std::max(top_, part.top);
  const int right = std::min(left_ + tile_side, part.left + part.width);
  const int bottom = std::min(top_ + tile_side, part.top + part.height);
  if (left >= right) return;
  const auto first = static_cast<std::size_t>(left - left_) * 4;
  const auto bytes = static_cast<std::size_t>(right - left) * 4;
  std::array<Mask, groups> pixels;
  if (flat_) pixels.fill(packed([this](std::size_t k) { return splat(colour_[k]); }));
  for (int y = top; y < bottom; ++y) {
    const auto row = static_cast<std::size_t>(y - top_);
    for (std::size_t group = 0; !flat_ && group < groups; ++group) {
      pixels[group] = packed([&](std::size_t k) { return planes_[k][row][group]; });
    }
    std::uint8_t* const to =
        frame + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(left));
    if (bytes == sizeof(pixels)) {
      std::memcpy(to, pixels.data(), sizeof(pixels));
    } else {
      std::memcpy(to, reinterpret_cast<const std::uint8_t*>(pixels.data()) + first, bytes);
    }
  }
}

}  // namespace pinchlab
