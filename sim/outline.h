// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Outlines of bodies: a disc, or a convex polygon whose corners may be rounded.

#include <cmath>
#include <span>

#include "base/at.h"
#include "sim/scene.h"

namespace pinchlab {

/// Corners of a polygon that can be told apart in a contact (Contact::point) and checked quickly.
constexpr int most_corners = 64;

inline bool is_polygon(const BodyProperties& body) {
  return !body.corners.empty();
}

/// Radius of the circles that the outline consists of: of a disc's only one, or of those about a
/// polygon's corners (m).
inline double rim_radius(const BodyProperties& body) {
  return is_polygon(body) ? body.corner_radius : body.radius;
}

/// Radius of the largest circle about the body's centre that its outline holds (m).
double inner_radius(const BodyProperties& body);

/// Vector x turned by `angle` (rad).
inline Vec2 turned(const Vec2& x, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * x.x() - s * x.y(), s * x.x() + c * x.y()};
}

/// Where an end is in the world when the scene starts (m).
inline Vec2 place_of(const Scene& scene, const Attachment& end) {
  if (end.body < 0) return end.point;
  const Body& body = at(scene.bodies, end.body);
  return body.position + turned(end.point, body.angle);
}

/// How far a point is from a polygon.
struct Outside {
  double distance = 0.0;     // m; below 0: inside, to the nearest side
  Vec2 normal = Vec2(1, 0);  // unit, the way out of the polygon
  bool round = false;        // the nearest is a corner, or a disc's centre, not a side
  int side = -1;             // of the polygon, from that corner on, that it is the distance from
};

/// Of a point from the polygon of these corners, counter-clockwise, all in one frame.
Outside outside_of(std::span<const Vec2> corners, const Vec2& point);

/// From one of its sides, gone on with to both ends.
Outside outside_of_side(std::span<const Vec2> corners, std::size_t side, const Vec2& point);

/// How far the polygon's point that is nearest to one outside of it is from where its side ends,
/// along it (m); below 0 it is a corner, and the one outside is so far beyond the nearer of the two
/// sides that meet there. Infinity inside.
double along_side(std::span<const Vec2> corners, const Vec2& point);

/// How far a point is from where one of its sides ends, along that (m): below 0 it is beyond.
double along_side(std::span<const Vec2> corners, std::size_t side, const Vec2& point);

/// As outside_of, from the polygon's sides whose ways out make an angle with `way` whose cosine is
/// at most `most`, gone on with to both ends: below 0 where the point is behind all of them.
Outside outside_of_sides(std::span<const Vec2> corners, const Vec2& point, const Vec2& way,
                         double most);

/// The way out of a polygon at a corner: the sum of those across the two sides that meet there.
Vec2 way_out_at(std::span<const Vec2> corners, int corner);

/// Least over `points` of how far they are in front of the polygon's side that parts them from it
/// most (m); below 0 no side does.
double parted_by(std::span<const Vec2> corners, std::span<const Vec2> points);

/// What a plate of this outline and of unit density has.
struct Plate {
  double area = 0.0;           // m^2
  Vec2 centre = Vec2::Zero();  // m, of mass
  double second_moment = 0.0;  // m^4, polar, about `centre`
};

/// Exact, the rounded corners included. The corners are counter-clockwise.
Plate plate_of(std::span<const Vec2> corners, double corner_radius);

/// Whether corners make a convex polygon, counter-clockwise, that has no straight corner and does
/// not go round more than once.
bool is_convex(std::span<const Vec2> corners);

/// Gives the body this outline, and the inertia of an even plate of its mass if it has none of its
/// own. The plate's centre is to be the origin of the corners' frame: make_world sees to it.
void make_polygon(BodyProperties& body, std::vector<Vec2> corners, double corner_radius);

}  // namespace pinchlab
