// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_changes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "render/tile.h"

namespace pinchlab {

namespace {

constexpr int tile_width = 16, tile_height = 8;  // px, even

/// Whether both have the same shapes, each of as many pieces as it may be.
bool same_shapes(const Mesh& a, const Mesh& b) {
  return a.sheets() == b.sheets() &&
         std::equal(a.shapes().begin(), a.shapes().end(), b.shapes().begin(), b.shapes().end(),
                    [](const MeshShape& one, const MeshShape& other) {
                      return one.program == other.program && one.texture == other.texture;
                    });
}

constexpr float margin = 1.0f;  // px, for the rasteriser's rounding
constexpr float unbounded = std::numeric_limits<float>::infinity();

/// A coordinate as a whole number within 0..size; 0 if it is not a number.
int within(float value, int size) {
  return static_cast<int>(std::fmin(std::fmax(std::ceil(value), 0.0f), static_cast<float>(size)));
}

using Point = std::array<float, 2>;               // px
using Corners = std::array<Point, quad_corners>;  // of a quad, in a mesh' order

Corners corners_of(const Vertex* quad) {
  return {quad[0].position, quad[1].position, quad[2].position, quad[3].position};
}

/// A grid of tiles over the frame, each changed or not.
class Tiles {
 public:
  Tiles(int width, int height)
      : width_(width),
        height_(height),
        columns_((width + tile_width - 1) / tile_width),
        rows_((height + tile_height - 1) / tile_height),
        changed_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {}

  /// Every tile that the triangles of a quad can touch, but those that `spared` says lie within
  /// what does not change.
  template <typename Spared>
  void mark(const Corners& quad, const Spared& spared) {
    const std::array<Point, quad_corners + 1> round = {quad[0], quad[1], quad[3], quad[2], quad[0]};
    float low = unbounded, high = -unbounded;
    for (const Point& corner : round) {
      low = std::min(low, corner[1]);
      high = std::max(high, corner[1]);
    }
    const int first = within(low - margin, height_) / tile_height;
    const int end = (within(high + margin, height_) + tile_height - 1) / tile_height;
    for (int row = first; row < end; ++row) {
      float left = unbounded, right = -unbounded;
      for (std::size_t i = 0; i < quad_corners; ++i) {
        widen(round[i], round[i + 1], static_cast<float>(row * tile_height) - margin,
              static_cast<float>((row + 1) * tile_height) + margin, left, right);
      }
      const int from = within(left - margin, width_) / tile_width;
      const int to = (within(right + margin, width_) + tile_width - 1) / tile_width;
      for (int column = from; column < to; ++column) {
        if (!spared(column * tile_width, row * tile_height)) at(column, row) = 1;
      }
    }
  }
  void mark(const Corners& quad) {
    mark(quad, [](int, int) { return false; });
  }

  /// Runs of changed tiles, row by row.
  std::vector<PixelRect> rectangles() {
    std::vector<PixelRect> found;
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        if (at(column, row) == 0) continue;
        const int first = column;
        while (column < columns_ && at(column, row) != 0) ++column;
        const int left = first * tile_width, top = row * tile_height;
        found.push_back({left, top, std::min(column * tile_width, width_) - left,
                         std::min(top + tile_height, height_) - top});
      }
    }
    return found;
  }

 private:
  /// Widens left..right to the part of the side from a to b that lies between the rows top and
  /// bottom.
  static void widen(const Point& a, const Point& b, float top, float bottom, float& left,
                    float& right) {
    const auto [ax, ay] = a;
    const auto [bx, by] = b;
    if (std::max(ay, by) < top || std::min(ay, by) > bottom) return;
    for (const float y : {std::clamp(ay, top, bottom), std::clamp(by, top, bottom)}) {
      const float x = ay == by ? ax : ax + (bx - ax) * (y - ay) / (by - ay);
      left = std::min(left, x);
      right = std::max(right, x);
    }
    if (ay == by) {
      left = std::min(left, bx);
      right = std::max(right, bx);
    }
  }

  char& at(int column, int row) {
    return changed_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  }

  int width_, height_, columns_, rows_;
  std::vector<char> changed_;
};

/// Whether two discs differ in place alone.
bool same_disc(const Vertex* before, const Vertex* now) {
  const Vertex &a = before[0], &b = now[0];
  return a.shape[0] == 0.0f && a.shape == b.shape && a.fill == b.fill && a.edge == b.edge;
}

/// The inside of a disc has one colour: where it was inside and still is, nothing changes.
void mark_moved_disc(const Vertex* before, const Vertex* now, Tiles& tiles) {
  const float inside = now[0].shape[2] - 0.5f - margin;
  const auto centre = [](const Vertex* disc) {
    return Point{0.5f * (disc[0].position[0] + disc[3].position[0]),
                 0.5f * (disc[0].position[1] + disc[3].position[1])};
  };
  const std::array<Point, 2> centres = {centre(before), centre(now)};
  const auto spared = [&](int left, int top) {
    return std::all_of(centres.begin(), centres.end(), [&](const Point& c) {
      const auto x = static_cast<float>(left), y = static_cast<float>(top);
      return std::hypot(std::max(c[0] - x, x + tile_width - c[0]),
                        std::max(c[1] - y, y + tile_height - c[1])) < inside;
    });
  };
  tiles.mark(corners_of(before), spared);
  tiles.mark(corners_of(now), spared);
}

/// Whether two pieces of a cable have the same place and shape.
bool only_marks_differ(const Vertex* before, const Vertex* now) {
  return std::equal(before, before + quad_corners, now, [](const Vertex& a, const Vertex& b) {
    return a.position == b.position && a.place == b.place && a.shape == b.shape &&
           a.curve[0] == b.curve[0] && a.fill == b.fill && a.edge == b.edge && a.mark == b.mark;
  });
}

/// A piece of a cable by the frame in which its shader sees it.
class CablePiece {
 public:
  explicit CablePiece(const Vertex* quad)
      : place_(quad[0].place), position_(quad[0].position), radius_(quad[0].curve[0]) {
    // Positions are places turned, perhaps mirrored, and moved.
    const auto from_first = [quad](std::size_t i, auto part) {
      return Point{(quad[i].*part)[0] - (quad[0].*part)[0],
                   (quad[i].*part)[1] - (quad[0].*part)[1]};
    };
    const Point p = from_first(1, &Vertex::place), q = from_first(2, &Vertex::place);
    const Point a = from_first(1, &Vertex::position), b = from_first(2, &Vertex::position);
    const float determinant = p[0] * q[1] - p[1] * q[0];
    sound_ = std::abs(determinant) > 1.0f;
    for (std::size_t k = 0; k < 2; ++k) {
      x_axis_[k] = (a[k] * q[1] - b[k] * p[1]) / determinant;
      y_axis_[k] = (b[k] * p[0] - a[k] * q[0]) / determinant;
    }
    for (std::size_t i = 0; i < quad_corners; ++i) {
      const float s = along(quad[i].place);
      from_ = std::min(from_, s);
      to_ = std::max(to_, s);
    }
    reach_ = quad[0].shape[0] + 0.5f;
    sound_ = sound_ && (radius_ == 0.0f || radius_ > 2.0f * reach_);
  }

  bool sound() const { return sound_; }  // not: too small or too bent to be cut
  float from() const { return from_; }   // px along the piece
  float to() const { return to_; }

  /// A quad round what lies between two places along the piece.
  Corners between(float from, float to) const {
    const float turn = radius_ > 0.0f ? (to - from) / radius_ : 0.0f;
    const float outer = (radius_ + reach_) / std::cos(0.5f * turn), inner = radius_ - reach_;
    return {position(inner, from), position(outer, from), position(inner, to), position(outer, to)};
  }

 private:
  float along(const Point& place) const {
    return radius_ > 0.0f ? radius_ * std::atan2(place[1], place[0]) : place[1];
  }
  /// `x`: px from the arc's centre, or to the right of a straight piece.
  Point position(float x, float s) const {
    const float angle = radius_ > 0.0f ? s / radius_ : 0.0f;
    const float px = x * std::cos(angle) - place_[0];
    const float py = (radius_ > 0.0f ? x * std::sin(angle) : s) - place_[1];
    return {position_[0] + px * x_axis_[0] + py * y_axis_[0],
            position_[1] + px * x_axis_[1] + py * y_axis_[1]};
  }

  Point place_, position_;  // of the first corner
  Point x_axis_{}, y_axis_{};
  float radius_, reach_ = 0.0f;  // px
  float from_ = unbounded, to_ = -unbounded;
  bool sound_ = false;
};

/// What a pixel `s` px along a piece shows, if all within `reach` px show the same: 0 the cable's
/// colour, 1 a mark's.
std::optional<int> mark_at(const Vertex& v, float s, float reach) {
  const float m = v.curve[1] + v.curve[2] * s, off = m - std::round(m);
  const float beyond = v.shape[2] * std::abs(off) - v.shape[3];  // px from the mark's edge
  if (std::abs(beyond) < 0.5f + reach * std::max(1.0f, v.shape[2] * std::abs(v.curve[2])))
    return {};
  return beyond < 0.0f ? 1 : 0;
}

/// Where marks come and go, and their edges.
void mark_moved_marks(const Vertex* before, const Vertex* now, Tiles& tiles) {
  const CablePiece piece(now);
  if (!piece.sound()) return tiles.mark(corners_of(now));
  constexpr float stride = 2.0f;  // px
  const float end = piece.to() + margin;
  for (float s = piece.from() - margin; s < end;) {
    const float from = s;
    const auto differs = [&](float at) {
      const std::optional<int> shown = mark_at(*before, at, stride);
      return !shown || shown != mark_at(*now, at, stride);
    };
    while (s < end && differs(s + 0.5f * stride)) s += stride;
    if (s > from) {
      tiles.mark(piece.between(from, s));
    } else {
      s += stride;
    }
  }
}

/// Where the drawing of a quad has changed.
void mark_change(Program program, const Vertex* before, const Vertex* now, bool same_frame,
                 Tiles& tiles) {
  if (same_frame && std::equal(before, before + quad_corners, now)) return;
  if (program == Program::strip && same_frame && only_marks_differ(before, now)) {
    mark_moved_marks(before, now, tiles);
  } else if (program == Program::stroke && same_disc(before, now)) {
    mark_moved_disc(before, now, tiles);
  } else {
    tiles.mark(corners_of(before));
    tiles.mark(corners_of(now));
  }
}

PixelRect around(const PixelRect& a, const PixelRect& b) {
  const int left = std::min(a.left, b.left), top = std::min(a.top, b.top);
  return {left, top, std::max(a.left + a.width, b.left + b.width) - left,
          std::max(a.top + a.height, b.top + b.height) - top};
}

int area(const PixelRect& r) {
  return r.width * r.height;
}

/// Fewer and larger rectangles, for each costs a canvas as much as some pixels do; no two overlap.
void join(std::vector<PixelRect>& parts, int cost) {
  for (bool joined = true; joined;) {
    joined = false;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      for (std::size_t k = i + 1; k < parts.size();) {
        const PixelRect both = around(parts[i], parts[k]);
        if (!overlap(parts[i], parts[k]) && area(both) > area(parts[i]) + area(parts[k]) + cost) {
          ++k;
          continue;
        }
        parts[i] = both;
        parts[k] = parts.back();
        parts.pop_back();
        joined = true;
      }
    }
  }
}

}  // namespace

PixelRect quad_bounds(const Vertex* quad, int width, int height) {
  float left = unbounded, top = unbounded, right = -unbounded, bottom = -unbounded;
  for (std::size_t i = 0; i < quad_corners; ++i) {
    const auto [x, y] = quad[i].position;
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
  const int first = within(left - margin - 1.0f, width), row = within(top - margin - 1.0f, height);
  return {first, row, within(right + margin, width) - first, within(bottom + margin, height) - row};
}

std::vector<PixelRect> frame_changes(const Mesh& before, const Mesh& now, int width, int height,
                                     int cost) {
  if (!same_shapes(before, now)) return {{0, 0, width, height}};
  Tiles tiles(width, height);
  const auto end_of = [](const Mesh& mesh, std::size_t shape) {
    return shape + 1 < mesh.shapes().size() ? mesh.shapes()[shape + 1].first : mesh.quad_count();
  };
  for (std::size_t i = 0; i < now.shapes().size(); ++i) {
    const std::size_t old_first = before.shapes()[i].first, first = now.shapes()[i].first;
    const std::size_t old_count = end_of(before, i) - old_first, count = end_of(now, i) - first;
    for (std::size_t k = 0; k < std::max(old_count, count); ++k) {
      if (old_count == count) {
        mark_change(now.shapes()[i].program, before.quad(old_first + k), now.quad(first + k),
                    before.frame(old_first + k) == now.frame(first + k), tiles);
      } else {
        if (k < old_count) tiles.mark(corners_of(before.quad(old_first + k)));
        if (k < count) tiles.mark(corners_of(now.quad(first + k)));
      }
    }
  }
  std::vector<PixelRect> parts = tiles.rectangles();
  if (cost > 0) join(parts, cost);
  return parts;
}

}  // namespace pinchlab
