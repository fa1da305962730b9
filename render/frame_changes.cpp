// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_changes.h"

#include <algorithm>
#include <cmath>

namespace pinchlab {

namespace {

constexpr std::size_t corners = 4;  // a mesh consists of quads
constexpr int band = 16;            // px, the height of a rectangle

bool same_structure(const Mesh& a, const Mesh& b) {
  return a.sheets() == b.sheets() && a.batches() == b.batches() &&
         a.vertices().size() == b.vertices().size();
}

/// The columns of each band of rows that changed.
class Bands {
 public:
  Bands(int width, int height)
      : width_(width),
        height_(height),
        spans_(static_cast<std::size_t>((height + band - 1) / band)) {}

  /// Everything that the triangles of a quad can touch.
  void mark(const Vertex* quad) {
    float low_x = quad[0].position[0], high_x = low_x, low_y = quad[0].position[1], high_y = low_y;
    for (std::size_t i = 1; i < corners; ++i) {
      low_x = std::min(low_x, quad[i].position[0]);
      high_x = std::max(high_x, quad[i].position[0]);
      low_y = std::min(low_y, quad[i].position[1]);
      high_y = std::max(high_y, quad[i].position[1]);
    }
    const int left = within(std::floor(low_x) - 1.0f, width_),
              right = within(std::ceil(high_x) + 1.0f, width_);
    const int top = within(std::floor(low_y) - 1.0f, height_),
              bottom = within(std::ceil(high_y) + 1.0f, height_);
    if (left >= right) return;
    for (int y = top; y < bottom; y += band - y % band) {
      Span& span = spans_[static_cast<std::size_t>(y / band)];
      span.left = std::min(span.left, left);
      span.right = std::max(span.right, right);
    }
  }

  std::vector<PixelRect> rectangles() const {
    std::vector<PixelRect> found;
    for (std::size_t i = 0; i < spans_.size(); ++i) {
      const Span& span = spans_[i];
      if (span.left >= span.right) continue;
      const int top = static_cast<int>(i) * band;
      const int left = span.left / 2 * 2, right = std::min((span.right + 1) / 2 * 2, width_);
      found.push_back({left, top, right - left, std::min(band, height_ - top)});
    }
    return found;
  }

 private:
  struct Span {
    int left = 1 << 30, right = 0;
  };

  static int within(float value, int size) {
    return static_cast<int>(std::fmin(std::fmax(value, 0.0f), static_cast<float>(size)));
  }

  int width_, height_;
  std::vector<Span> spans_;
};

}  // namespace

std::vector<PixelRect> frame_changes(const Mesh& before, const Mesh& now, int width, int height) {
  if (!same_structure(before, now)) return {{0, 0, width, height}};
  Bands bands(width, height);
  for (std::size_t i = 0; i < now.vertices().size(); i += corners) {
    const Vertex *old_quad = before.vertices().data() + i, *new_quad = now.vertices().data() + i;
    if (std::equal(old_quad, old_quad + corners, new_quad)) continue;
    bands.mark(old_quad);
    bands.mark(new_quad);
  }
  return bands.rectangles();
}

}  // namespace pinchlab
