// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// START HERE: one step of the simulation.

#include "sim/make_world.h"
#include "sim/stages.h"
#include "sim/workspace.h"

namespace pinchlab {

/// Advances `world` by one step of world.step_length seconds: leapfrog, the first kick half a step
/// long, constraints solved at the positions that the kick is made at. Smooth motion is second
/// order in the step. After StepStatus::failed the world is not usable and world.failure says
/// where and when. With `times` each stage is timed.
///
/// `work` may be any Workspace: one that served the step before makes this one faster, and changes
/// no bit of it.
StepStatus step(const Scene& scene, World& world, Workspace& work, StageTimes* times = nullptr);

/// Velocities at the time of the positions (m/s, rad/s, one a body), second-order accurate: the
/// mean of the half-step velocities before and after. Costs what forces, rows and solve of a step
/// cost.
struct Velocities {
  std::vector<Vec2> linear;
  std::vector<double> angular;
};
Velocities velocities_now(const Scene& scene, const World& world, Workspace& work);

}  // namespace pinchlab
