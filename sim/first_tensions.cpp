// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/first_tensions.h"

#include <algorithm>

#include "base/at.h"
#include "sim/at_steps.h"
#include "sim/solve/forces.h"
#include "sim/solve/light_bodies.h"
#include "sim/solve/motors.h"
#include "sim/solve/passive.h"
#include "sim/solve/solution.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// A first step whose nodes are steadied by other tensions is no error, only worse.
constexpr int most_trials = 10;

bool are_finite(const PartSystem& s) {
  return std::ranges::all_of(s.velocity, [](const Eigen::Vector3d& v) { return v.allFinite(); });
}

/// Tensions of a part at time 0, in system `s`. A light body that is not held yet gives way and
/// lowers them, so that it takes some trials.
void find_tensions(const Scene& scene, World& world, Workspace& work, const Part& part,
                   PartSystem& s) {
  Stopwatch untimed(nullptr);
  TimeSpan t = whole_step(world);
  t.clamps = locates_events(world.configuration);
  for (int trial = 0; trial < most_trials; ++trial) {
    apply_forces(scene, world, t, work.parts, part, s);
    if (trial > 0 && !steady_light_bodies(world, work.parts, part, t.kick, s)) return;
    if (locates_events(world.configuration)) {
      t.made_up = t.reach = s.reach;
      solve_steadily(scene, world, work, part, t, most_motor_changes, untimed);
    } else {
      solve_at_steps(scene, world, work, part, t, untimed);
    }
    if (!are_finite(s)) return;  // the first step will tell
    store_tensions(s, t.kick, world);
    if (!part.can_move) return;  // no body is light
  }
}

}  // namespace

void find_first_tensions(const Scene& scene, World& world, Workspace& work) {
  work.systems.resize(1);
  for (Part part : work.parts.list) {
    if (part.asleep || part.cables_begin == part.cables_end) continue;
    part.system = 0;
    forget(work.systems[0]);
    find_tensions(scene, world, work, part, work.systems[0]);
  }
}

}  // namespace pinchlab
