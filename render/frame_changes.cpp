// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_changes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pinchlab {

namespace {

constexpr int tile_width = 32, tile_height = 16;  // px, even

bool same_structure(const Mesh& a, const Mesh& b) {
  return a.sheets() == b.sheets() && a.batches() == b.batches() &&
         a.vertices().size() == b.vertices().size();
}

constexpr float margin = 1.0f;  // px, for the rasteriser's rounding
constexpr float unbounded = std::numeric_limits<float>::infinity();

/// A coordinate as a whole number within 0..size; 0 if it is not a number.
int within(float value, int size) {
  return static_cast<int>(std::fmin(std::fmax(std::ceil(value), 0.0f), static_cast<float>(size)));
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

  /// Every tile that the triangles of a quad can touch.
  void mark(const Vertex* quad) {
    // Once round.
    const std::array<const Vertex*, quad_corners + 1> round = {quad, quad + 1, quad + 3, quad + 2,
                                                               quad};
    float low = unbounded, high = -unbounded;
    for (const Vertex* corner : round) {
      low = std::min(low, corner->position[1]);
      high = std::max(high, corner->position[1]);
    }
    const int first = within(low - margin, height_) / tile_height;
    const int end = (within(high + margin, height_) + tile_height - 1) / tile_height;
    for (int row = first; row < end; ++row) {
      float left = unbounded, right = -unbounded;
      for (std::size_t i = 0; i < quad_corners; ++i) {
        widen(*round[i], *round[i + 1], static_cast<float>(row * tile_height) - margin,
              static_cast<float>((row + 1) * tile_height) + margin, left, right);
      }
      const int from = within(left - margin, width_) / tile_width;
      const int to = (within(right + margin, width_) + tile_width - 1) / tile_width;
      for (int column = from; column < to; ++column) at(column, row) = 1;
    }
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
  static void widen(const Vertex& a, const Vertex& b, float top, float bottom, float& left,
                    float& right) {
    const float ax = a.position[0], ay = a.position[1], bx = b.position[0], by = b.position[1];
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

PixelRect around(const PixelRect& a, const PixelRect& b) {
  const int left = std::min(a.left, b.left), top = std::min(a.top, b.top);
  return {left, top, std::max(a.left + a.width, b.left + b.width) - left,
          std::max(a.top + a.height, b.top + b.height) - top};
}

int area(const PixelRect& r) {
  return r.width * r.height;
}

/// Fewer and larger rectangles, for each costs a canvas as much as some pixels do; no two overlap.
void join(std::vector<PixelRect>& parts) {
  constexpr int cost = 6000;  // px
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

std::vector<PixelRect> frame_changes(const Mesh& before, const Mesh& now, int width, int height) {
  if (!same_structure(before, now)) return {{0, 0, width, height}};
  Tiles tiles(width, height);
  for (std::size_t i = 0; i < now.vertices().size(); i += quad_corners) {
    const Vertex *old_quad = before.vertices().data() + i, *new_quad = now.vertices().data() + i;
    if (std::equal(old_quad, old_quad + quad_corners, new_quad)) continue;
    tiles.mark(old_quad);
    tiles.mark(new_quad);
  }
  std::vector<PixelRect> parts = tiles.rectangles();
  join(parts);
  return parts;
}

}  // namespace pinchlab
