// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/clearance.h"

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/touch.h"

namespace pinchlab {

double clearance_of(const Scene& scene, const World& world, const Contact& contact) {
  if (contact.touch != Touch::circles) {
    return meeting_of(scene, world, contact).gap - target_of(world, contact);
  }
  const Vec2& a = at(world.position, contact.a);
  const Vec2 b = contact.b >= 0 ? at(world.position, contact.b)
                                : nearest_point(at(scene.walls, contact.wall), a);
  const double radii = at(world.bodies, contact.a).radius +
                       (contact.b >= 0 ? at(world.bodies, contact.b).radius : 0.0);
  // What has gone through the other is on its far side.
  const Vec2 d = b - a;
  const double distance = d.dot(contact.normal) < 0.0 ? -d.norm() : d.norm();
  return distance - radii - target_of(world, contact);
}

double reach_at(const World& world, int body) {
  return within_reach *
         (at(world.position, body).cwiseAbs().maxCoeff() + at(world.bodies, body).radius);
}

}  // namespace pinchlab
