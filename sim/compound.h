// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Compounds: rigid bodies of several outlines, each a disc or a convex polygon. The body itself has
// the mass and moves; a shape of it is a body of the scene that is carried along, with an outline
// and surfaces of its own. Rows of what touches a shape act on the body that carries it.

#include <span>
#include <vector>

#include "base/at.h"
#include "sim/outline.h"
#include "sim/world.h"

namespace pinchlab {

/// An outline of a compound and its surfaces: of `properties` radius, corners, corner_radius,
/// frictions and restitution count. Corners are in the shape's own frame, whose origin may be
/// anywhere.
struct Shape {
  BodyProperties properties;
  Vec2 place = Vec2::
      Zero();  ///< m, of its frame's origin in the compound's, whose own is its centre of mass
  double angle = 0.0;  ///< rad, by which its frame is turned there
};

/// What even plates of these outlines and of unit density have together, as if none lay on others.
Plate plate_of(std::span<const Shape> shapes);

/// Gives the scene's body `body` these shapes in place of an outline of its own: bodies after all
/// that there are, called as it is with ":1", ":2" and so on. They do not touch one another. Its
/// mass, inertia (if it has none: of even plates) and centre of mass are the body's. Moving the
/// body afterwards does not move its shapes.
void add_shapes(Scene& scene, int body, std::span<const Shape> shapes);

/// The bodies that have the outlines of a body: itself, or its shapes.
std::vector<int> outlines_of(const Scene& scene, int body);

/// Lets two bodies pass each other.
void keep_apart(Scene& scene, int body, int other);

/// The body whose motion `body` has: itself, or the compound that it is a shape of.
inline int mover_of(const World& world, int body) {
  if (world.carried.empty()) return body;
  const int carrier = at(world.bodies, body).carrier;
  return carrier >= 0 ? carrier : body;
}

/// From the centre of what a body moves with to its own (m).
inline Vec2 seat_of(const World& world, int body) {
  return at(world.position, body) - at(world.position, mover_of(world, body));
}

/// Places a shape, and sets its velocity, by the body that carries it.
void carry(World& world, int shape);
inline void carry(World& world, std::span<const int> shapes) {
  for (const int shape : shapes) carry(world, shape);
}

/// What the body turns about where nothing holds it (m).
inline const Vec2& pivot_of(const World& world, int body) {
  return at(world.position, mover_of(world, body));
}

}  // namespace pinchlab
