// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/build.h"

#include <fmt/format.h>

#include <utility>

namespace pinchlab::build {

Body body(std::string name, BodyKind kind, const Vec2& position, double radius, double mass) {
  Body b;
  b.name = std::move(name);
  b.kind = kind;
  b.position = position;
  b.radius = radius;
  b.mass = mass;
  return b;
}

Body body(std::string name, BodyKind kind, double x, double y, double radius, double mass) {
  return body(std::move(name), kind, {x, y}, radius, mass);
}

Attachment at(double x, double y) {
  return {-1, {x, y}};
}

Attachment on(int body) {
  return {body, {0.0, 0.0}};
}

Cable cable(const Attachment& start, std::vector<Wrap> wraps, const Attachment& end,
            double half_width) {
  Cable c;
  c.name = "cable";
  c.half_width = half_width;
  c.start = start;
  c.wraps = std::move(wraps);
  c.end = end;
  return c;
}

std::vector<Wrap> over_and_under(int first, int count) {
  constexpr int clockwise = -1, counter_clockwise = 1;
  std::vector<Wrap> wraps;
  wraps.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    wraps.push_back({first + i, i % 2 == 0 ? clockwise : counter_clockwise, 0});
  }
  return wraps;
}

Scene load_chain(int pulleys, double left, double right, double pulley_mass,
                 double cable_friction) {
  constexpr double spacing = 1.5, reach = pulley_radius + cable_half_width;
  Scene scene;
  scene.bodies.push_back(body("left", BodyKind::free, -reach, -3.0, 0.2, left));
  scene.bodies.push_back(
      body("right", BodyKind::free, spacing * (pulleys - 1) + reach, -3.0, 0.2, right));
  for (int i = 0; i < pulleys; ++i) {
    scene.bodies.push_back(body(fmt::format("pulley {}", i), BodyKind::fixed_axle, spacing * i, 0.0,
                                pulley_radius, pulley_mass));
    scene.bodies.back().cable_friction = cable_friction;
  }
  scene.cables.push_back(cable(on(0), over_and_under(2, pulleys), on(1)));
  return scene;
}

}  // namespace pinchlab::build
