// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/mesh.h"

#include <algorithm>
#include <cmath>

#include "sim/tangent.h"

namespace pinchlab {

namespace {

constexpr double fringe = 0.5;  // px outside a shape's edge that still see some of it

float narrow(double value) {
  return static_cast<float>(value);
}

std::array<float, 2> narrow(const Vec2& p) {
  return {narrow(p.x()), narrow(p.y())};
}

}  // namespace

Piece::Piece(const Vec2& from, const Vec2& to, const Vec2& from_tangent, const Vec2& to_tangent)
    : middle(0.5 * (from + to)), length((to - from).norm()) {
  constexpr double no_length = 1e-6;  // px
  if (length < no_length) length = 0.0;
  // y points down here, so the left of (x, y) is (y, -x).
  turn = -std::atan2(cross(from_tangent, to_tangent), from_tangent.dot(to_tangent));
  along =
      length > 0.0 ? Vec2((to - from) / length) : Vec2((from_tangent + to_tangent).normalized());
  constexpr double straight = 1e-4;  // rad: the arc strays by 1e-3 px from a chord of 80 px
  constexpr double least = 1e-3;     // px: the round joint of a kink
  if (std::abs(turn) >= straight) {
    radius = std::max(least, 0.5 * length / std::sin(0.5 * std::abs(turn)));
  }
}

Fit::Fit(const View& view, int left, int width, int height) {
  const Vec2 size = view.high - view.low, middle = 0.5 * (view.low + view.high);
  scale = std::min(width / size.x(), height / size.y());
  origin = Vec2(left + 0.5 * width - scale * middle.x(), 0.5 * height + scale * middle.y());
}

void Mesh::clear() {
  vertices_.clear();
  frames_.clear();
  batches_.clear();
  sheets_.clear();
  shapes_.clear();
  open_ = false;
}

void Mesh::end_sheet(int left, int width, Colour background) {
  sheets_.push_back({left, width, background, batches_.size()});
  open_ = false;
}

void Mesh::begin(Program program, std::uint32_t texture) {
  shapes_.push_back({program, texture, quad_count()});
  if (!open_ || batches_.back().program != program || batches_.back().texture != texture) {
    batches_.push_back({program, texture, vertices_.size() / quad_corners, 0});
    open_ = true;
  }
}

void Mesh::add_quad(const std::array<Vec2, 4>& positions, const std::array<Vec2, 4>& places,
                    const Vertex& common, const Frame& frame) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Vertex& v = vertices_.emplace_back(common);
    v.position = narrow(positions[i]);
    v.place = narrow(places[i]);
  }
  frames_.push_back(frame);
  ++batches_.back().count;
}

void Mesh::add(const Stroke& stroke, const Fit& fit) {
  begin(Program::stroke);
  const Vec2 a = fit.point(stroke.a), b = fit.point(stroke.b);
  const double length = (b - a).norm(), half = fit.scale * stroke.half_width, reach = half + fringe;
  const Vec2 along = length > 0.0 ? Vec2((b - a) / length) : Vec2(1.0, 0.0);
  const Vec2 across(-along.y(), along.x());
  Vertex common{};
  common.shape = {narrow(length), narrow(half),
                  narrow(std::max(0.0, half - fit.scale * stroke.edge_width)), 0.0f};
  common.fill = stroke.fill;
  common.edge = stroke.edge;
  std::array<Vec2, 4> positions, places;
  for (std::size_t i = 0; i < 4; ++i) {
    places[i] = {i < 2 ? -reach : length + reach, i % 2 == 0 ? -reach : reach};
    positions[i] = a + places[i].x() * along + places[i].y() * across;
  }
  Frame frame;
  frame.origin = narrow(a);
  frame.x_axis = narrow(along);
  frame.y_axis = narrow(across);
  add_quad(positions, places, common, frame);
}

// Neighbouring pieces share the corners between them, so that no pixel is missed or drawn twice. On
// the outer side of an arc they lie further out, where the chord between them clears the arc.
void Mesh::find_sides(double reach) {
  sides_.assign(pieces_.size() + 1, {reach, reach});
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    if (piece.radius == 0.0) continue;
    const double outside = (piece.radius + reach) / std::cos(0.5 * piece.turn) - piece.radius;
    for (Side* side : {&sides_[i], &sides_[i + 1]}) {
      double& extent = piece.turn > 0.0 ? side->right : side->left;
      extent = std::max(extent, outside);
    }
  }
}

void Mesh::add(const Strip& strip, const std::vector<StripPoint>& points, const Fit& fit) {
  if (strip.count < 2) return;
  const StripPoint* const first = points.data() + strip.first;
  pieces_.clear();
  for (std::size_t i = 0; i + 1 < strip.count; ++i) {
    pieces_.emplace_back(fit.point(first[i].position), fit.point(first[i + 1].position),
                         Fit::vector(first[i].tangent), Fit::vector(first[i + 1].tangent));
  }
  const double half = fit.scale * strip.half_width;
  find_sides(half + fringe);

  begin(Program::strip);
  Vertex common{};
  common.shape = {narrow(half), narrow(std::max(0.0, half - fit.scale * strip.edge_width)),
                  narrow(fit.scale * strip.mark_spacing),
                  narrow(0.5 * fit.scale * strip.mark_length)};
  common.fill = strip.fill;
  common.edge = strip.edge;
  common.mark = strip.mark;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    if (piece.length == 0.0 && piece.radius == 0.0) continue;
    // The piece's own frame: x outwards from the arc's centre (to the right of a straight piece,
    // from its middle), y along it.
    const Vec2 right(-piece.along.y(), piece.along.x());
    const bool turns_right = piece.radius > 0.0 && piece.turn < 0.0;
    const Vec2 outwards = turns_right ? Vec2(-right) : right;
    const Vec2 origin = piece.middle - piece.radius * std::cos(0.5 * piece.turn) * outwards;
    std::array<Vec2, 4> positions, places;
    for (std::size_t k = 0; k < 4; ++k) {
      const StripPoint& point = first[i + k / 2];
      const Side& side = sides_[i + k / 2];
      const Vec2 tangent = Fit::vector(point.tangent);
      // A bend tighter than the strip is wide must not reach beyond its centre.
      const double most = piece.radius > 0.0 ? piece.radius : infinity;
      const double offset = k % 2 == 0 ? -(turns_right ? side.left : std::min(side.left, most))
                                       : (turns_right ? std::min(side.right, most) : side.right);
      positions[k] = fit.point(point.position) + offset * Vec2(-tangent.y(), tangent.x());
      places[k] = {(positions[k] - origin).dot(outwards), (positions[k] - origin).dot(piece.along)};
    }
    // Marks repeat, so whole spacings are left out: single precision is enough for what remains.
    const double from = first[i].material / strip.mark_spacing;
    const double to = first[i + 1].material / strip.mark_spacing;
    const double middle = 0.5 * (from + to);
    const double length = piece.radius > 0.0 ? piece.radius * std::abs(piece.turn) : piece.length;
    common.curve = {narrow(piece.radius), narrow(middle - std::floor(middle)),
                    length > 0.0 ? narrow((to - from) / length) : 0.0f};
    Frame frame;
    frame.origin = narrow(piece.middle);
    frame.x_axis = narrow(outwards);
    frame.y_axis = narrow(piece.along);
    frame.centre = narrow(piece.radius * std::cos(0.5 * piece.turn));
    frame.half_chord = narrow(0.5 * piece.length);
    frame.from = narrow(fit.point(first[i].position));
    frame.from_along = narrow(Fit::vector(first[i].tangent));
    frame.to = narrow(fit.point(first[i + 1].position));
    frame.to_along = narrow(Fit::vector(first[i + 1].tangent));
    add_quad(positions, places, common, frame);
  }
}

// A fan of triangles, each a quad whose last corner counts twice. To the stroke program every pixel
// of theirs is on the middle line of a wide stroke, which is no disc.
void Mesh::add(const Patch& patch, const std::vector<Vec2>& corners, const Fit& fit) {
  begin(Program::stroke);
  Vertex common{};
  common.shape = {1.0f, 1e3f, 1e3f, 0.0f};
  common.fill = patch.fill;
  const Vec2* const first = corners.data() + patch.first;
  for (std::size_t i = 1; i + 1 < patch.count; ++i) {
    const Vec2 last = fit.point(first[i + 1]);
    add_quad({fit.point(first[0]), fit.point(first[i]), last, last},
             {Vec2::Zero(), Vec2::Zero(), Vec2::Zero(), Vec2::Zero()}, common, {});
  }
}

void Mesh::add(const Label& label, const LabelImage& image, const Fit& fit) {
  begin(Program::label, image.texture);
  const Vec2 corner = fit.point(label.centre) - Vec2(image.centre_x, image.centre_y);
  Vertex common{};
  common.fill = label.colour;
  std::array<Vec2, 4> positions, places;
  for (std::size_t i = 0; i < 4; ++i) {
    places[i] = {i < 2 ? 0.0 : 1.0, i % 2 == 0 ? 0.0 : 1.0};
    positions[i] = corner + Vec2(places[i].x() * image.width, places[i].y() * image.height);
  }
  Frame frame;
  frame.origin = narrow(corner);
  add_quad(positions, places, common, frame);
}

}  // namespace pinchlab
