// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/at.h"
#include "render/frame_changes.h"
#include "render/painter.h"
#include "render/tile.h"

namespace pinchlab {

namespace {

class TilePainter : public Painter {
 public:
  TilePainter(int width, int height)
      : width_(width),
        height_(height),
        columns_((width + tile_side - 1) / tile_side),
        place_(static_cast<std::size_t>(columns_) *
               static_cast<std::size_t>((height + tile_side - 1) / tile_side)) {}

  std::uint32_t keep(TextBitmap image) override {
    images_.push_back(std::move(image));
    return static_cast<std::uint32_t>(images_.size());
  }
  void forget_images() override { images_.clear(); }
  int rectangle_cost() const override { return 0; }

  void paint(const Mesh& mesh, const std::vector<PixelRect>& changed, bool /*first*/,
             std::uint8_t* pixels) override {
    find_tiles(changed);
    std::size_t batch = 0;
    for (const Sheet& sheet : mesh.sheets()) {
      sort_brushes(mesh, batch, sheet.end);
      batch = sheet.end;
      const PixelRect columns{sheet.left, 0, sheet.width, height_};
      const Premultiplied paper = premultiplied(sheet.background);
      for (std::size_t i = 0; i < tiles_.size(); ++i) {
        const int left = tiles_[i] % columns_ * tile_side, top = tiles_[i] / columns_ * tile_side;
        if (overlap({left, top, tile_side, tile_side}, columns)) {
          tile_.draw(left, top, paper, brushes_in_[i]);
          tile_.store(pixels, width_, columns);
        }
        brushes_in_[i].clear();
      }
    }
    for (const int tile : tiles_) at(place_, tile) = 0;
  }

 private:
  template <typename Do>
  void each_tile(const PixelRect& part, const Do& act) const {
    const int right = (part.left + part.width + tile_side - 1) / tile_side;
    const int bottom = (part.top + part.height + tile_side - 1) / tile_side;
    for (int row = part.top / tile_side; row < bottom; ++row) {
      for (int column = part.left / tile_side; column < right; ++column) {
        act(row * columns_ + column);
      }
    }
  }

  void find_tiles(const std::vector<PixelRect>& changed) {
    tiles_.clear();
    for (const PixelRect& part : changed) {
      each_tile(part, [this](int tile) {
        std::size_t& place = at(place_, tile);
        if (place != 0) return;
        tiles_.push_back(tile);
        place = tiles_.size();
      });
    }
    if (brushes_in_.size() < tiles_.size()) brushes_in_.resize(tiles_.size());
  }

  /// The quads of batches first..end - 1, into the changed tiles in which they may be seen.
  void sort_brushes(const Mesh& mesh, std::size_t first, std::size_t end) {
    std::size_t quads = 0;
    for (std::size_t i = first; i < end; ++i) quads += mesh.batches()[i].count;
    brushes_.clear();
    brushes_.reserve(quads);  // tiles point to them
    for (std::size_t i = first; i < end; ++i) {
      const Batch& batch = mesh.batches()[i];
      const TextBitmap* const image = batch.texture > 0 ? &images_[batch.texture - 1] : nullptr;
      for (std::size_t q = batch.first; q < batch.first + batch.count; ++q) {
        const Vertex* const quad = mesh.quad(q);
        const Brush* brush = nullptr;
        each_tile(quad_bounds(quad, width_, height_), [&](int tile) {
          const std::size_t place = at(place_, tile);
          if (place == 0) return;
          if (brush == nullptr) {
            brush = &brushes_.emplace_back(make_brush(batch.program, quad, mesh.frame(q), image));
          }
          brushes_in_[place - 1].push_back(brush);
        });
      }
    }
  }

  int width_, height_, columns_;
  std::vector<TextBitmap> images_;
  std::vector<Brush> brushes_;
  std::vector<int> tiles_;                             // that have changed, numbered row by row
  std::vector<std::vector<const Brush*>> brushes_in_;  // as many or more
  std::vector<std::size_t> place_;  // by tile: 1 + its place in tiles_; 0 if it has not changed
  Tile tile_;
};

}  // namespace

std::unique_ptr<Painter> make_tile_painter(int width, int height) {
  return std::make_unique<TilePainter>(width, height);
}

}  // namespace pinchlab
