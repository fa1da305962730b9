// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The momentum of bodies and of the cables with mass that they carry.

#include <vector>

#include "sim/cable/mass.h"
#include "sim/cable/sleeve.h"
#include "sim/compound.h"
#include "sim/outline.h"
#include "sim/step.h"
#include "sim/tangent.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {

/// Linear momentum (N s) of all in a scene without gravity, and the angular one about the origin.
/// What slips does so at the mean of the speeds half a step before and after.
inline Eigen::Vector3d momentum_of(const Scene& scene, const World& world) {
  World now = world, next = world;
  Workspace work, of_next;
  const Velocities present = velocities_now(scene, world, work);
  now.velocity = present.linear;
  now.angular_velocity = present.angular;
  EXPECT_EQ(step(scene, next, of_next), StepStatus::ok);
  for (std::size_t i = 0; i < now.cables[0].links.size(); ++i) {
    Link& link = now.cables[0].links[i];
    link.slip_speed = 0.5 * (link.slip_speed + next.cables[0].links[i].slip_speed);
  }
  std::vector<Eigen::Matrix3d> carried;
  std::vector<Sleeve> sleeves;
  find_carried(world, carried, sleeves);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const auto add = [&sum](const Eigen::Vector3d& p, const Vec2& centre) {
    sum += p + Eigen::Vector3d(0.0, 0.0, cross(centre, Vec2(p.head<2>())));
  };
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const BodyProperties& body = world.bodies[b];
    const Eigen::Vector3d v(now.velocity[b].x(), now.velocity[b].y(), now.angular_velocity[b]);
    const bool moves = body.carrier < 0 && can_move(body);
    const Eigen::Vector3d own =
        moves ? Eigen::Vector3d(body.mass * v.x(), body.mass * v.y(), inertia_of(body) * v.z())
              : Eigen::Vector3d::Zero();
    add(own + carried[b] * v, world.position[b]);
  }
  for (const Sleeve& sleeve : sleeves) {
    const Vec2& centre = world.position[static_cast<std::size_t>(mover_of(world, sleeve.body))];
    add(sleeve.mass * velocity_of(now, sleeve), centre + sleeve.centre);
  }
  return sum;
}

}  // namespace pinchlab::testing
