// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/clearance.h"

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/touch.h"

namespace pinchlab {

double clearance_of(const World& world, const Contact& contact) {
  return gap_of(world, contact) - target_of(world, contact);
}

double reach_at(const World& world, int body) {
  return within_reach *
         (at(world.position, body).cwiseAbs().maxCoeff() + at(world.bodies, body).radius);
}

}  // namespace pinchlab
