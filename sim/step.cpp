// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step.h"

#include <algorithm>

#include "base/at.h"
#include "sim/at_steps.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/cable/strung.h"
#include "sim/compound.h"
#include "sim/detect/detect.h"
#include "sim/diagnostics.h"
#include "sim/motion/advance.h"
#include "sim/motion/catch_up.h"
#include "sim/solve/forces.h"
#include "sim/solve/solution.h"
#include "sim/tangent.h"
#include "sim/thesis/gauss_seidel.h"

namespace pinchlab {

namespace {

/// Positions, and the material that slides over bodies, with the velocities just found.
void move_bodies(const Parts& parts, World& world) {
  const double h = world.step_length;
  for (const Part& part : parts.list) {
    if (part.asleep) continue;
    for (const int number : bodies_of(parts, part)) {
      const auto b = index(number);
      world.position[b] += h * world.velocity[b];
      world.angle[b] += h * world.angular_velocity[b];
    }
    carry(world, carried_of(parts, part));
    if (!part.slides) continue;
    for (const int c : cables_of(parts, part)) {
      for (Link& link : at(world.cables, c).links) link.material -= h * link.slip_speed;
    }
  }
}

bool all_asleep(const Parts& parts) {
  return std::all_of(parts.list.begin(), parts.list.end(),
                     [](const Part& part) { return part.asleep; });
}

void solve_parts(const Scene& scene, World& world, Workspace& work, Stopwatch& watch) {
  Diagnostics& d = world.diagnostics;
  d.active_set_solves = 0;
  for (Part& part : work.parts.list) {
    if (part.asleep) continue;
    if (!solve_at_steps(scene, world, work, part, whole_step(world), watch)) ++d.fallbacks;
    PartSystem& s = at(work.systems, part.system);
    store_solution(work.parts, part, s, work.solve.capstan, whole_step(world), world);
    if (world.configuration.solver == Solver::iterative && !s.rows.empty()) {
      store_middles(s, work.solve, work.sweeps, world);
    }
    part.slides = !work.solve.capstan.runs.empty() || part.can_slip || !s.sleeves.empty();
    d.active_set_solves = std::max(d.active_set_solves, work.solve.solves);
    note_rest(scene, work.parts, part, world);
    watch.lap(Stage::solve);
  }
  d.total_solves += d.active_set_solves;
}

/// A step in one: events take effect in the step in which they fall.
StepStatus advance_at_once(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  Stopwatch watch(times);
  apply_forces(scene, world, whole_step(world), work);
  watch.lap(Stage::apply_forces);
  solve_parts(scene, world, work, watch);
  if (!check_finite(scene, world)) return StepStatus::failed;
  if (world.configuration.diagnostics) {
    world.diagnostics.energy += kinetic_energy(world, work.before, world.step_length);
  }
  watch.lap(Stage::diagnose);
  work.start.position = world.position;
  work.start.angle = world.angle;
  move_bodies(work.parts, world);
  if (world.step == 0) {  // from now on velocities are half a step behind
    std::fill(world.pace.begin(), world.pace.end(), Pace{.lag = 0.5 * world.step_length});
  }
  watch.lap(Stage::move_bodies);
  detect(scene, world, work, times);
  return StepStatus::ok;
}

}  // namespace

StepStatus step(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  fit(world, work);
  if (all_asleep(work.parts)) {
    world.diagnostics.active_set_solves = 0;
    ++world.step;
    mark(world, work);
    return StepStatus::ok;
  }
  if (world.configuration.diagnostics) {
    note_instant(world, work.before);
    world.diagnostics.energy = potential_energy(scene, world);
  }
  const int changes = world.changes;
  const StepStatus status = locates_events(world.configuration)
                                ? advance(scene, world, work, times)
                                : advance_at_once(scene, world, work, times);
  if (status != StepStatus::ok) return status;
  if (!check_positions(scene, world)) return StepStatus::failed;
  if (world.changes != changes && !check_corners(scene, world)) return StepStatus::failed;
  ++world.step;
  Stopwatch watch(times);
  turn_pieces(work.parts, world);
  if (world.configuration.diagnostics) measure_cables(scene, world);
  mark(world, work);
  watch.lap(Stage::diagnose);
  return StepStatus::ok;
}

Velocities velocities_now(const Scene& scene, const World& world, Workspace& work) {
  Velocities now{world.velocity, world.angular_velocity};
  if (world.step == 0) return now;
  fit(world, work);
  const bool located = locates_events(world.configuration);
  Stopwatch untimed(nullptr);
  if (located) {
    put_together(world, work.parts, work.neighbourhoods);
    for (const int p : work.neighbourhoods.parts.items) {
      find_present_velocities(scene, world, at(work.parts.list, p), world.time(), work);
    }
  } else {
    apply_forces(scene, world, whole_step(world), work);
  }
  for (const Part& part : work.parts.list) {
    if (part.asleep) continue;
    if (!located) solve_at_steps(scene, world, work, part, whole_step(world), untimed);
    const PartSystem& s = at(work.systems, part.system);
    const std::span<const int> bodies = bodies_of(work.parts, part);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Vec2& linear = at(now.linear, bodies[i]);
      double& angular = at(now.angular, bodies[i]);
      if (located) {
        linear = s.velocity[i].head<2>();
        angular = s.velocity[i].z();
      } else {  // the mean of half a step before and after
        linear = 0.5 * (linear + s.velocity[i].head<2>());
        angular = 0.5 * (angular + s.velocity[i].z());
      }
    }
    for (const int shape : carried_of(work.parts, part)) {
      const int mover = mover_of(world, shape);
      const double turning = at(now.angular, mover);
      at(now.angular, shape) = turning;
      at(now.linear, shape) = at(now.linear, mover) + turning * left(seat_of(world, shape));
    }
  }
  for (const NodeChain& chain : scene.chains) carry_velocities(world, chain, now.linear);
  for (const int c : world.strung) carry_velocities(world, at(world.cables, c), now.linear);
  return now;
}

const char* to_string(Stage stage) {
  constexpr const char* names[] = {"apply_forces",  "init_segments",     "init_contacts",
                                   "solve",         "move_bodies",       "update_segments",
                                   "remove_links",  "broad_phase",       "intersect_segments",
                                   "find_contacts", "configure_pinches", "diagnose"};
  static_assert(std::size(names) == static_cast<std::size_t>(Stage::count));
  return names[static_cast<std::size_t>(stage)];
}

}  // namespace pinchlab
