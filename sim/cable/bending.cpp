// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/bending.h"

#include <cmath>

#include "base/at.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// From one direction to the other (rad), the shorter way round.
double angle_between(const Vec2& from, const Vec2& to) {
  return std::atan2(cross(from, to), from.dot(to));
}

}  // namespace

// E = bend th^2 / 2 with th = alpha_2 - alpha_1, and a piece's ends turn it by
// d alpha = n . (d end - d start) / length.
BendForces bend_forces(const World& world, const CableState& cable) {
  const Segment& first = cable.segments[1];
  const Segment& second = at(world.cables, cable.bends_with).segments[1];
  const double moment = cable.bend * angle_between(first.direction, second.direction);
  const Vec2 a = moment / first.length * left(first.direction);
  const Vec2 b = moment / second.length * left(second.direction);
  return {-a, a + b, -b};
}

double bending_energy(const World& world, const CableState& cable) {
  const Segment& second = at(world.cables, cable.bends_with).segments[1];
  const double angle = angle_between(cable.segments[1].direction, second.direction);
  return 0.5 * cable.bend * angle * angle;
}

}  // namespace pinchlab
