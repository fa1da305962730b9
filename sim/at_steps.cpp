// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/at_steps.h"

#include "base/at.h"
#include "sim/solve/active_set.h"
#include "sim/solve/light_bodies.h"
#include "sim/solve/motors.h"
#include "sim/thesis/gauss_seidel.h"
#include "sim/workspace.h"

namespace pinchlab {

TimeSpan whole_step(const World& world) {
  TimeSpan interval;
  interval.start = world.time();
  interval.length = interval.repair = world.step_length;
  interval.lag = world.step > 0 ? 0.5 * world.step_length : 0.0;
  interval.kick = interval.lag + 0.5 * world.step_length;
  return interval;
}

bool solve_at_steps(const Scene& scene, const World& world, Workspace& work, const Part& part,
                    const TimeSpan& interval, Stopwatch& watch) {
  PartSystem& s = at(work.systems, part.system);
  steady_light_bodies(world, work.parts, part, interval.kick, s);
  return solve_with_motors(scene, world, work, part, interval, watch, [&] {
    if (world.configuration.solver == Solver::direct) {
      return solve_direct(world, work.parts, part, s, work.solve);
    }
    solve_iterative(world, work.parts, part, s, work.solve, work.sweeps);
    return true;
  });
}

}  // namespace pinchlab
