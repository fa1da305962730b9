// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// START HERE: one step of the simulation.

#include "sim/world.h"

namespace pinchlab {

/// Advances `world` by one step of world.step_length seconds. After StepStatus::not_finite the world
/// is not usable and world.failure says where and when.
StepStatus step(const Scene& scene, World& world);

/// Velocities at the time of the positions (m/s, rad/s, one a body), second-order accurate: the mean
/// of the half-step velocities before and after. Costs about one step; does not change the world.
struct Velocities {
  std::vector<Vec2> linear;
  std::vector<double> angular;
};
Velocities velocities_now(const Scene& scene, const World& world);

}  // namespace pinchlab
