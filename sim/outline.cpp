// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// Unit, out of the polygon across its side from corner i on; `length` (m) of that side.
Vec2 way_out(std::span<const Vec2> corners, std::size_t i, double& length) {
  const Vec2 side = corners[(i + 1) % corners.size()] - corners[i];
  length = side.norm();
  return -left(side) / length;
}

/// The side that a point is furthest in front of.
struct Front {
  std::size_t side = 0;          // from that corner on
  double distance = -infinity;   // m; below 0: behind it
  Vec2 normal = Vec2(1.0, 0.0);  // unit, out of it
  double length = 0.0;           // m
};

Front front_of(std::span<const Vec2> corners, const Vec2& point) {
  Front front;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    double length = 0.0;
    const Vec2 normal = way_out(corners, i, length);
    const double distance = normal.dot(point - corners[i]);
    if (distance > front.distance) front = {i, distance, normal, length};
  }
  return front;
}

/// Adds a part of the plate to it, moments about the origin: `moment` is the part's about its own
/// centre.
void add(Plate& plate, double area, const Vec2& centre, double moment) {
  plate.area += area;
  plate.centre += area * centre;
  plate.second_moment += moment + area * centre.squaredNorm();
}

}  // namespace

Outside outside_of(std::span<const Vec2> corners, const Vec2& point) {
  const auto [side, in_front, normal, length] = front_of(corners, point);
  Outside out{in_front, normal, false, static_cast<int>(side)};
  if (out.distance <= 0.0) return out;
  // Of all sides that the point is in front of, the one that it is furthest from holds the nearest
  // point of the polygon, within it or at one of its ends.
  const double along = left(normal).dot(point - corners[side]);
  if (along >= 0.0 && along <= length) return out;
  const Vec2 end = along < 0.0 ? corners[side] : corners[(side + 1) % corners.size()];
  const double distance = (point - end).norm();
  return {distance, (point - end) / distance, true};
}

Outside outside_of_side(std::span<const Vec2> corners, std::size_t side, const Vec2& point) {
  double length = 0.0;
  const Vec2 normal = way_out(corners, side, length);
  return {normal.dot(point - corners[side]), normal, false, static_cast<int>(side)};
}

double along_side(std::span<const Vec2> corners, std::size_t side, const Vec2& point) {
  double length = 0.0;
  const double along = left(way_out(corners, side, length)).dot(point - corners[side]);
  return std::min(along, length - along);
}

double along_side(std::span<const Vec2> corners, const Vec2& point) {
  const auto [side, in_front, normal, length] = front_of(corners, point);
  if (in_front <= 0.0) return infinity;
  const double here = along_side(corners, side, point);
  if (here >= 0.0) return here;
  // Beyond an end: so it may be of the side that begins, or ends, there.
  const std::size_t count = corners.size();
  const bool before = left(normal).dot(point - corners[side]) < 0.0;
  return std::max(here, along_side(corners, (side + (before ? count - 1 : 1)) % count, point));
}

Outside outside_of_sides(std::span<const Vec2> corners, const Vec2& point, const Vec2& way,
                         double most) {
  Outside out;
  out.distance = -infinity;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Outside of_side = outside_of_side(corners, i, point);
    if (of_side.normal.dot(way) > most) continue;
    if (of_side.distance > out.distance) out = of_side;
  }
  return out;
}

Vec2 way_out_at(std::span<const Vec2> corners, int corner) {
  const auto here = static_cast<std::size_t>(corner), count = corners.size();
  double length = 0.0;
  return way_out(corners, (here + count - 1) % count, length) + way_out(corners, here, length);
}

double parted_by(std::span<const Vec2> corners, std::span<const Vec2> points) {
  double most = -infinity;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    double length = 0.0, least = infinity;
    const Vec2 normal = way_out(corners, i, length);
    for (const Vec2& point : points) least = std::min(least, normal.dot(point - corners[i]));
    most = std::max(most, least);
  }
  return most;
}

double inner_radius(const BodyProperties& body) {
  if (!is_polygon(body)) return body.radius;
  return body.corner_radius - outside_of(body.corners, Vec2::Zero()).distance;
}

// The polygon is a sum of triangles from the origin; its rounded outline adds a strip to each side
// and a sector to each corner. Of a sector of half angle b and radius r the centre lies
//     2 r sin b / (3 b)
// from the corner, and its moment about the corner is b r^4 / 2.
Plate plate_of(std::span<const Vec2> corners, double r) {
  Plate plate;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 &p = corners[i], &q = corners[(i + 1) % corners.size()];
    const double area = 0.5 * cross(p, q);
    plate.area += area;
    plate.centre += area * (p + q) / 3.0;
    plate.second_moment += area * (p.dot(p) + p.dot(q) + q.dot(q)) / 6.0;
    if (r == 0.0) continue;
    double length = 0.0, length_before = 0.0;
    const Vec2 out = way_out(corners, i, length);
    const Vec2 before = way_out(corners, (i + corners.size() - 1) % corners.size(), length_before);
    add(plate, length * r, 0.5 * (p + q) + 0.5 * r * out,
        length * r * (length * length + r * r) / 12.0);
    const double half = 0.5 * std::atan2(cross(before, out), before.dot(out));
    const double sector = half * r * r, from_corner = 2.0 * r * std::sin(half) / (3.0 * half);
    add(plate, sector, p + from_corner * (before + out).normalized(),
        0.5 * sector * r * r - sector * from_corner * from_corner);
  }
  plate.centre /= plate.area;
  plate.second_moment -= plate.area * plate.centre.squaredNorm();
  return plate;
}

bool is_convex(std::span<const Vec2> corners) {
  if (corners.size() < 3) return false;
  constexpr double least_turn = 1e-6;  // rad: less is a straight line in a file's decimal figures
  double turn = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    double length = 0.0, length_after = 0.0;
    const Vec2 here = way_out(corners, i, length);
    const Vec2 after = way_out(corners, (i + 1) % corners.size(), length_after);
    const double angle = std::atan2(cross(here, after), here.dot(after));
    if (!(angle > least_turn)) return false;  // NaN of a side without length too
    turn += angle;
  }
  return turn < 3.0 * std::numbers::pi;
}

void make_polygon(BodyProperties& body, std::vector<Vec2> corners, double corner_radius) {
  double furthest = 0.0;
  for (const Vec2& corner : corners) furthest = std::max(furthest, corner.norm());
  body.radius = furthest + corner_radius;
  const Plate plate = plate_of(corners, corner_radius);
  if (!body.inertia) body.inertia = body.mass / plate.area * plate.second_moment;
  body.corners = std::move(corners);
  body.corner_radius = corner_radius;
}

}  // namespace pinchlab
