// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/piece_line.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/compound.h"
#include "sim/lines.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// Whether the line passes the body, or what it is a shape of.
bool passes(const World& world, const Line& line, int body) {
  const int mover = mover_of(world, body);
  return std::ranges::any_of(line.passes, [&](int b) { return b == body || b == mover; });
}

/// m, by which a body may move in two steps.
double motion_of(const Scene& scene, const World& world, std::size_t body) {
  const double h = world.step_length;
  return 2.0 * h * (world.velocity[body].norm() + h * scene.gravity.norm());
}

}  // namespace

double curvature(const Line& line, const Segment& other) {
  const double angle = std::atan2(std::abs(cross(line.direction, other.direction)),
                                  line.direction.dot(other.direction));
  return 2.0 * angle / (line.length + other.length);
}

void find_surroundings(const Scene& scene, const World& world, BoxTree& near) {
  near.clear();
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const BodyProperties& body = world.bodies[b];
    if (body.node || !body.outlined) continue;
    const Vec2 reach = Vec2::Constant(body.radius + motion_of(scene, world, b) / hysteresis);
    near.add(world.position[b] - reach, world.position[b] + reach, static_cast<int>(b));
  }
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall& wall = scene.walls[w];
    near.add(wall.a.cwiseMin(wall.b), wall.a.cwiseMax(wall.b), -1 - static_cast<int>(w));
  }
  near.build();
}

bool is_near_something(const Scene& scene, const World& world, const BoxTree& near,
                       const Line& line, double off, double times) {
  const Vec2 start = link_centre(world, *line.from);
  const Vec2 end = link_centre(world, *line.to);
  const double h = world.step_length;
  const double speed =
      std::max(end_velocity(world, *line.from).norm(), end_velocity(world, *line.to).norm()) +
      h * scene.gravity.norm();
  const double own = off + 2.0 * h * speed;
  const auto meets = [&](int number) {
    if (number < 0) {
      const Wall& wall = at(scene.walls, -1 - number);
      return distance_between_lines(start, end, wall.a, wall.b) < times * own;
    }
    if (passes(world, line, number)) return false;
    const double reach = own + motion_of(scene, world, index(number));
    return distance_from_line(start, end, at(world.position, number)) <
           at(world.bodies, number).radius + times * reach;
  };
  const Vec2 room = Vec2::Constant(times * own);
  return near.any(start.cwiseMin(end) - room, start.cwiseMax(end) + room, meets);
}

double spread_of(const World& world, const Line& line) {
  return 0.125 * (end_velocity(world, *line.to) - end_velocity(world, *line.from)).squaredNorm();
}

double swing_of(double mass, const Vec2& motion, const Vec2& pull, const Line& line,
                const Segment& before, const Segment& after) {
  const double energy = 0.5 * motion.squaredNorm();
  const double stiffness = before.tension / before.length + after.tension / after.length;  // N/m
  if (!(stiffness > 0.0)) return energy;
  const double drawn =
      cross(line.direction, after.tension * after.direction - before.tension * before.direction);
  // Where all falls with it, less of what pulls is to be borne.
  const double borne = cross(line.direction, pull);
  const double across = drawn + std::clamp(-drawn, std::min(borne, 0.0), std::max(borne, 0.0));
  return energy + 0.5 * across * across / (stiffness * mass);
}

bool is_in_contact(const World& world, int node) {
  return std::any_of(world.contacts.begin(), world.contacts.end(), [node](const Contact& contact) {
    return contact.a == node || contact.b == node;
  });
}

double wanted_share(const Scene& scene, const Segment& line, double spare, const Vec2& held) {
  if (!(line.tension > 0.0 && spare > 0.0)) return infinity;
  const double across = held.y() * scene.gravity.dot(left(line.direction));
  return std::max(across / (line.tension * spare), 0.0);
}

double share_let_out(const Scene& scene, double step_length, double wanted, double c,
                     double& rate) {
  // A share that is to be left: nothing changes. A bend is within the tolerance, and a thousandth
  // of that does not show; so a cable at rest hangs as it hung.
  constexpr double enough = 0.999;
  if (wanted >= enough) {
    rate = 0.0;
    return 1.0;
  }
  const double swing = std::sqrt(scene.gravity.norm() / c);
  rate += step_length * swing * (swing * (1.0 - wanted) - 2.0 * rate);
  return std::max(1.0 - step_length * rate, wanted);
}

}  // namespace pinchlab
