// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tips.h"

#include <array>
#include <cmath>

#include "base/at.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "sim/touch.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// Where a tip is (m), and between which of its ways out (unit, the first turned on to the second
/// counter-clockwise) its outline has it: those of the sides beside a corner, or either side of a
/// wall's end.
struct SharpTip {
  Vec2 place;
  std::array<Vec2, 2> cone;
};

SharpTip tip_of(const World& world, const Contact& contact, int owner) {
  if (owner < 0) {
    const Obstacle& wall = at(world.obstacles, contact.wall);
    const Vec2 along = (wall.b - wall.a).normalized();
    const Vec2 out = contact.point == 0 ? Vec2(-along) : along;
    return {contact.point == 0 ? wall.a : wall.b, {-left(out), left(out)}};
  }
  const std::vector<Vec2>& corners = at(world.bodies, owner).corners;
  const std::size_t here = index(contact.point), count = corners.size();
  const double angle = at(world.angle, owner);
  const auto way_out = [&](std::size_t side) {
    return turned(outside_of_side(corners, side, Vec2::Zero()).normal, angle);
  };
  return {place_of_point(world, owner, contact.point),
          {way_out((here + count - 1) % count), way_out(here)}};
}

/// Whether a side of that way out (unit) may lie on the tip.
bool bears(const SharpTip& tip, const Vec2& way_out) {
  constexpr double rounding = 1e-9;
  return cross(tip.cone[0], -way_out) >= -rounding && cross(-way_out, tip.cone[1]) >= -rounding;
}

}  // namespace

bool goes_past(const World& world, double near, Contact& contact) {
  if (contact.side < 0 || contact.gap < -near) return false;
  const bool of_a = contact.touch == Touch::point_of_a;
  const int owner = of_a ? contact.a : contact.b, other = of_a ? contact.b : contact.a;
  const SharpTip tip = tip_of(world, contact, owner);
  const std::vector<Vec2>& corners = at(world.bodies, other).corners;
  const double angle = at(world.angle, other);
  const Vec2 seen = turned(tip.place - at(world.position, other), -angle);
  for (const std::size_t step : {std::size_t{1}, corners.size() - 1}) {
    const std::size_t next = (index(contact.side) + step) % corners.size();
    const Outside out = outside_of_side(corners, next, seen);
    const Vec2 way_out = turned(out.normal, angle);
    if (std::abs(out.distance) > near || !bears(tip, way_out)) continue;
    if (contact.gap > near) return true;
    const Vec2 normal = of_a ? Vec2(-way_out) : way_out;
    const Vec2 velocity = relative_velocity(world, contact, tip.place);
    const double parting = velocity.dot(contact.normal);
    if (parting >= 0.0 || velocity.dot(normal) <= parting) continue;
    contact.normal = normal;
    contact.side = static_cast<std::int8_t>(next);
    contact.gap = out.distance;
  }
  return false;
}

}  // namespace pinchlab
