// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/canvas.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <utility>

#include "base/at.h"
#include "render/frame_changes.h"
#include "render/mesh.h"
#include "render/painter.h"
#include "render/text.h"

namespace pinchlab {

std::unique_ptr<Painter> make_painter(int width, int height) {
  if (std::getenv("PINCHLAB_GL") == nullptr) return make_tile_painter(width, height);
#if defined(PINCHLAB_OPENGL)
  return make_gl_painter(width, height);
#else
  throw std::runtime_error(
      "PINCHLAB_GL: there is no OpenGL in this program; leave it unset, or build with Debian's "
      "libosmesa6-dev or libegl-dev");
#endif
}

struct Canvas::State {
  int width, height;
  std::unique_ptr<Painter> painter = make_painter(width, height);
  Font font;
  std::map<std::pair<std::string, int>, LabelImage> labels;  // by text and size in 1/64 px
  Mesh mesh, last_mesh;
  std::vector<PixelRect> changed;
  std::vector<std::uint8_t> pixels;

  State(int width_, int height_) : width(width_), height(height_) {
    pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  }

  const LabelImage& image_of(const std::string& text, double height_px) {
    const int size = static_cast<int>(std::lround(64.0 * height_px));
    LabelImage& label = labels[{text, size}];
    if (label.texture != 0) return label;
    TextBitmap bitmap = font.draw(text, size / 64.0);
    label = {0, bitmap.width, bitmap.height, bitmap.centre_x, bitmap.centre_y};
    label.texture = painter->keep(std::move(bitmap));
    return label;
  }

  void build(const Picture& picture, int left, int columns) {
    const Fit fit(picture.view, left, columns, height);
    for (const Picture::Item& item : picture.order) {
      switch (item.kind) {
        case Picture::Kind::stroke:
          mesh.add(picture.strokes[item.index], fit);
          break;
        case Picture::Kind::strip:
          mesh.add(picture.strips[item.index], picture.points, fit);
          break;
        case Picture::Kind::patch:
          mesh.add(picture.patches[item.index], picture.corners, fit);
          break;
        case Picture::Kind::label: {
          const Label& label = picture.labels[item.index];
          mesh.add(label, image_of(label.text, fit.scale * label.height), fit);
          break;
        }
      }
    }
    mesh.end_sheet(left, columns, picture.background);
  }

  void draw(std::span<const Picture* const> pictures) {
    constexpr std::size_t enough_labels = 500;
    if (labels.size() > enough_labels) {
      painter->forget_images();
      labels.clear();
    }
    mesh.clear();
    const int count = static_cast<int>(pictures.size());
    for (int i = 0; i < count; ++i) {
      const int left = width * i / count;
      build(*at(pictures, i), left, width * (i + 1) / count - left);
    }
    changed = frame_changes(last_mesh, mesh, width, height, painter->rectangle_cost());
    if (!changed.empty()) {
      painter->paint(mesh, changed, mesh.sheets() != last_mesh.sheets(), pixels.data());
    }
    std::swap(mesh, last_mesh);
  }
};

Canvas::Canvas(int width, int height) {
  if (width < smallest_frame || height < smallest_frame || width > largest_frame ||
      height > largest_frame) {
    throw std::runtime_error(
        fmt::format("a frame of {} x {} px cannot be drawn: each side must be {} to {} px", width,
                    height, smallest_frame, largest_frame));
  }
  state_ = std::make_unique<State>(width, height);
}

Canvas::~Canvas() = default;

int Canvas::width() const {
  return state_->width;
}
int Canvas::height() const {
  return state_->height;
}

const std::vector<PixelRect>& Canvas::changed() const {
  return state_->changed;
}

const std::uint8_t* Canvas::draw(const Picture& picture) {
  const Picture* const one = &picture;
  return draw(std::span<const Picture* const>(&one, 1));
}

const std::uint8_t* Canvas::draw(std::span<const Picture* const> pictures) {
  if (pictures.empty()) throw std::runtime_error("nothing to draw: no picture given");
  state_->draw(pictures);
  return state_->pixels.data();
}

}  // namespace pinchlab
