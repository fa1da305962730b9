// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A picture's shapes as quads for a painter, in px.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/picture/picture.h"

namespace pinchlab {

/// World metres to px of the frame, from its top left. The view is shown as large as it goes in the
/// columns left .. left + width - 1, centred.
struct Fit {
  double scale;  // px/m
  Vec2 origin;   // px, of the world's origin
  Fit(const View& view, int left, int width, int height);
  Vec2 point(const Vec2& p) const {
    return {origin.x() + scale * p.x(), origin.y() - scale * p.y()};
  }
  static Vec2 vector(const Vec2& v) { return {v.x(), -v.y()}; }
};

/// How a quad is drawn: OpenGL's shader programs (gl.cpp), and what tile.cpp does likewise.
enum class Program : std::uint8_t { stroke, strip, label };

/// The one vertex layout; gl.cpp says what `place`, `shape` and `curve` mean to each program.
struct Vertex {
  std::array<float, 2> position, place;
  std::array<float, 4> shape;
  std::array<float, 3> curve;
  Colour fill, edge, mark;
  bool operator==(const Vertex&) const = default;
};

/// Where a quad's shape lies in the frame: the tile painter works from it, in places that do not
/// lose digits far from an arc's centre.
struct Frame {
  std::array<float, 2> origin{};  ///< px: a stroke's start, a text's corner, a chord's middle
  std::array<float, 2> x_axis{};  ///< unit: along a stroke; outwards from an arc's centre
  std::array<float, 2> y_axis{};  ///< unit: to the left of x_axis, or along a strip
  float centre = 0.0f;            ///< px from an arc's centre to the middle of its chord
  float half_chord = 0.0f;        ///< px
  /// The ends of a strip's piece: a point, px, and a unit vector along the strip. Neighbours share
  /// them, so that each pixel is within one piece.
  std::array<float, 2> from{}, from_along{}, to{}, to_along{};
  bool operator==(const Frame&) const = default;
};

/// The columns of the frame that one picture takes, and its background.
struct Sheet {
  int left, width;  // px
  Colour background;
  std::size_t end;  // the first batch of the next sheet
  bool operator==(const Sheet&) const = default;
};

/// Consecutive quads of one program, and of one texture if they are text.
struct Batch {
  Program program;
  std::uint32_t texture;
  std::size_t first, count;  // quads
  bool operator==(const Batch&) const = default;
};

/// The quads of one shape of a picture, from `first` on.
struct MeshShape {
  Program program;
  std::uint32_t texture;
  std::size_t first;
};

constexpr std::size_t quad_corners = 4;
/// The two triangles of a quad, by its corners.
constexpr std::array<std::uint32_t, 6> quad_triangles = {0, 1, 2, 2, 1, 3};

/// A piece of a strip between two points, px: the circular arc that joins them and turns by the
/// angle between their tangents.
struct Piece {
  Vec2 middle;    // of the chord
  Vec2 along;     // unit, of the chord; where the points coincide, halfway between the tangents
  double length;  // of the chord
  double turn;    // rad, positive to the left of `along` as seen in the picture
  double radius = 0.0;  // 0: straight
  Piece(const Vec2& from, const Vec2& to, const Vec2& from_tangent, const Vec2& to_tangent);
};

/// A text's image, by its painter's name for it.
struct LabelImage {
  std::uint32_t texture = 0;
  int width = 0, height = 0;              // px
  double centre_x = 0.0, centre_y = 0.0;  // px, see TextBitmap
};

/// Quads of four vertices each, in painter's order. Their corners come in two pairs, the ends of
/// opposite sides. Storage is kept by clear().
class Mesh {
 public:
  void add(const Stroke& stroke, const Fit& fit);
  void add(const Strip& strip, const std::vector<StripPoint>& points, const Fit& fit);
  void add(const Patch& patch, const std::vector<Vec2>& corners, const Fit& fit);
  void add(const Label& label, const LabelImage& image, const Fit& fit);
  /// Ends a picture that was drawn into the given columns, px.
  void end_sheet(int left, int width, Colour background);
  void clear();

  const std::vector<Vertex>& vertices() const { return vertices_; }
  const std::vector<Batch>& batches() const { return batches_; }
  const std::vector<Sheet>& sheets() const { return sheets_; }
  const std::vector<MeshShape>& shapes() const { return shapes_; }
  std::size_t quad_count() const { return vertices_.size() / quad_corners; }
  const Vertex* quad(std::size_t index) const { return vertices_.data() + index * quad_corners; }
  const Frame& frame(std::size_t quad) const { return frames_[quad]; }

 private:
  void find_sides(double reach);
  void begin(Program program, std::uint32_t texture = 0);
  void add_quad(const std::array<Vec2, 4>& positions, const std::array<Vec2, 4>& places,
                const Vertex& common, const Frame& frame);

  struct Side {  // of a strip's point: how far its triangles reach across, px
    double left, right;
  };

  std::vector<Vertex> vertices_;
  std::vector<Frame> frames_;  // one a quad
  std::vector<Batch> batches_;
  std::vector<Sheet> sheets_;
  std::vector<MeshShape> shapes_;
  std::vector<Piece> pieces_;  // of the strip being added
  std::vector<Side> sides_;    // of its points
  bool open_ = false;
};

}  // namespace pinchlab
