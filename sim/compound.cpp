// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/compound.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "sim/tangent.h"

namespace pinchlab {

namespace {

Plate plate_of_outline(const BodyProperties& outline) {
  if (is_polygon(outline)) return plate_of(outline.corners, outline.corner_radius);
  const double square = outline.radius * outline.radius;
  return {std::numbers::pi * square, Vec2::Zero(), 0.5 * std::numbers::pi * square * square};
}

/// Of a shape's own frame, in the compound's.
Vec2 in_compound(const Shape& shape, const Vec2& point) {
  return shape.place + turned(point, shape.angle);
}

/// The shape as a body, its polygon's corners about their own centre.
Body body_of(const Shape& shape, const Body& compound) {
  Body body;
  const BodyProperties& given = shape.properties;
  const Vec2 centre = plate_of_outline(given).centre;
  body.kind = is_static(compound) ? BodyKind::fixed : BodyKind::free;
  body.mass = 0.0;
  body.radius = given.radius;
  if (is_polygon(given)) {
    std::vector<Vec2> corners = given.corners;
    for (Vec2& corner : corners) corner -= centre;
    make_polygon(body, std::move(corners), given.corner_radius);
  }
  body.inertia.reset();
  body.cable_friction = given.cable_friction;
  body.contact_friction = given.contact_friction;
  body.restitution = given.restitution;
  body.seat = in_compound(shape, centre);
  body.seat_angle = shape.angle;
  body.position = compound.position + turned(body.seat, compound.angle);
  body.angle = compound.angle + body.seat_angle;
  return body;
}

}  // namespace

std::vector<int> outlines_of(const Scene& scene, int body) {
  if (at(scene.bodies, body).outlined) return {body};
  std::vector<int> shapes;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].carrier == body) shapes.push_back(static_cast<int>(b));
  }
  return shapes;
}

void keep_apart(Scene& scene, int body, int other) {
  const std::array<int, 2> pair{std::min(body, other), std::max(body, other)};
  const auto place = std::lower_bound(scene.apart.begin(), scene.apart.end(), pair);
  if (place == scene.apart.end() || *place != pair) scene.apart.insert(place, pair);
}

// Each by the theorem of parallel axes.
Plate plate_of(std::span<const Shape> shapes) {
  Plate all;
  for (const Shape& shape : shapes) {
    const Plate one = plate_of_outline(shape.properties);
    const Vec2 centre = in_compound(shape, one.centre);
    all.area += one.area;
    all.centre += one.area * centre;
    all.second_moment += one.second_moment + one.area * centre.squaredNorm();
  }
  all.centre /= all.area;
  all.second_moment -= all.area * all.centre.squaredNorm();
  return all;
}

void add_shapes(Scene& scene, int body, std::span<const Shape> shapes) {
  const int first = static_cast<int>(scene.bodies.size());
  double furthest = 0.0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Body& compound = at(scene.bodies, body);
    Body shape = body_of(shapes[i], compound);
    shape.name = compound.name + ":" + std::to_string(i + 1);
    shape.carrier = body;
    furthest = std::max(furthest, shape.seat.norm() + shape.radius);
    scene.bodies.push_back(std::move(shape));
  }
  Body& compound = at(scene.bodies, body);
  compound.outlined = false;
  compound.radius = furthest;
  if (!compound.inertia) {
    const Plate plate = plate_of(shapes);
    compound.inertia = compound.mass / plate.area * plate.second_moment;
  }
  const int end = static_cast<int>(scene.bodies.size());
  for (int a = first; a < end; ++a) {
    for (int b = a + 1; b < end; ++b) keep_apart(scene, a, b);
  }
}

void carry(World& world, int shape) {
  const BodyProperties& body = at(world.bodies, shape);
  const Vec2 seat = turned(body.seat, at(world.angle, body.carrier));
  const double turning = at(world.angular_velocity, body.carrier);
  at(world.position, shape) = at(world.position, body.carrier) + seat;
  at(world.angle, shape) = at(world.angle, body.carrier) + body.seat_angle;
  at(world.velocity, shape) = at(world.velocity, body.carrier) + turning * left(seat);
  at(world.angular_velocity, shape) = turning;
}

}  // namespace pinchlab
