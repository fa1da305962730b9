// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/advance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/compound.h"
#include "sim/detect/detect.h"
#include "sim/diagnostics.h"
#include "sim/motion/adapt_nodes.h"
#include "sim/motion/clearance.h"
#include "sim/motion/events.h"
#include "sim/motion/impact.h"
#include "sim/motion/interval.h"
#include "sim/motion/repair.h"
#include "sim/solve/forces.h"
#include "sim/solve/light_bodies.h"
#include "sim/solve/motors.h"
#include "sim/solve/passive.h"
#include "sim/solve/rows.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

constexpr int most_rebounds = 24;  // of a step's events: what comes after them does not rebound
constexpr int most_events = 48;    // that are located in one step

// Of links, in one step: 500, and ten a body. Where more come and go, spans are being wound round what they
// are in without end, each change making more, and steps last minutes.
constexpr std::int64_t most_changes = 500, most_changes_a_body = 10;

/// Velocities at the positions' time, with what bears force now.
void solve_present(const Scene& scene, const World& world, Workspace& work, const Part& part) {
  PartSystem& s = at(work.systems, part.system);
  TimeSpan t;
  t.repair = world.step_length;
  t.kick = t.lag = world.lag;
  t.reach = s.reach;
  t.held_only = t.clamps = true;
  steady_light_bodies(world, work.parts, part, t.kick, s);
  Stopwatch untimed(nullptr);
  solve_with_motors(scene, world, work, part, t, untimed,
                    [&] { return solve_passively(world, work.parts, part, s, work.solve); });
}

/// Brings the velocities to the positions' time.
void catch_up(const Scene& scene, World& world, double time, Workspace& work) {
  find_present_velocities(scene, world, time, work);
  for (const Part& part : work.parts.list) {
    if (part.asleep) continue;
    const PartSystem& s = at(work.systems, part.system);
    const std::span<const int> bodies = bodies_of(work.parts, part);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      at(world.velocity, bodies[i]) = s.velocity[i].head<2>();
      at(world.angular_velocity, bodies[i]) = s.velocity[i].z();
    }
    carry(world, carried_of(work.parts, part));
  }
  world.lag = 0.0;
}

/// Forces of an instant at the positions' time.
void apply_no_forces(const Scene& scene, const World& world, double time, Workspace& work) {
  TimeSpan instant;
  instant.start = time;
  apply_forces(scene, world, instant, work);
}

/// Whether a contact is, that can give.
bool is_squeezed(const World& world, const Parts& parts) {
  for (const Part& part : parts.list) {
    if (!part.can_move) continue;
    for (const int number : contacts_of(parts, part)) {
      const Contact& c = at(world.contacts, number);
      if (c.gap >= c.target - 10.0 * reach_at(world, c.a)) continue;
      if (can_move(at(world.bodies, c.a))) return true;
      if (c.b >= 0 && can_move(at(world.bodies, c.b))) return true;
    }
  }
  return false;
}

void strike_all(const Scene& scene, World& world, Workspace& work, double time, bool rebounds) {
  apply_no_forces(scene, world, time, work);
  for (const Part& part : work.parts.list) {
    if (!part.asleep) strike(scene, world, work, part, rebounds);
  }
}

/// Contacts have been found for what bodies may do in a step at the speeds that they had, twice as much as
/// that. Whether an impact has made one faster still.
bool hastens(const Scene& scene, const World& world, const std::vector<Vec2>& velocity,
             const std::vector<double>& angular_velocity) {
  const double slow = scene.gravity.norm() * world.step_length;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const double rim = world.bodies[b].radius;
    const double before = velocity[b].norm() + rim * std::abs(angular_velocity[b]);
    const double after = world.velocity[b].norm() + rim * std::abs(world.angular_velocity[b]);
    if (after > 2.0 * before + slow) return true;
  }
  return false;
}

/// Puts right in the positions what an interval has left, and then the velocities to fit them; whether
/// contacts have been found anew for these.
bool settle_end(const Scene& scene, World& world, Workspace& work, double time, bool violated,
                bool happened, bool rebounds, StageTimes* times) {
  if (violated || happened) apply_no_forces(scene, world, time, work);
  bool repaired = false;
  for (Part& part : work.parts.list) {
    if (part.asleep || !(violated || happened)) continue;
    repaired = repair(scene, world, work, part) || repaired;
  }
  if (repaired && world.lag > 0.0) catch_up(scene, world, time, work);
  if (!happened && !repaired) return false;
  Instant& found = work.found;
  found.velocity = world.velocity;
  found.turning = world.angular_velocity;
  strike_all(scene, world, work, time, rebounds);
  if (!hastens(scene, world, found.velocity, found.turning)) return false;
  detect_after_moving(scene, world, work, false, times);
  return true;
}

/// Elastic cables have come on to rims and off them in an interval.
void lay_down_cables(World& world, const Parts& parts) {
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    if (!world.cables[c].rims.empty() && !sleeps(parts, c)) lay_down(world, world.cables[c]);
  }
}

/// Makes cables of nodes finer and coarser.
void adapt_nodes(const Scene& scene, World& world, Workspace& work, double time,
                 StageTimes* times) {
  if (wants_other_nodes(scene, world, work)) {
    if (world.lag > 0.0) catch_up(scene, world, time, work);
    const double before = energy_of_motion(world);
    change_nodes(scene, world, work);
    detect_after_moving(scene, world, work, false, times);
    strike_all(scene, world, work, time, false);
    world.diagnostics.node_losses += before - energy_of_motion(world);
  }
  follow_chains(scene, world, work);
}

StepStatus fail_by_changes(World& world) {
  world.failure = fmt::format(
      "step {} (t = {} s): cables meet and leave bodies without end; move apart what they are in",
      world.step, world.time());
  return StepStatus::not_finite;
}

/// Moves the world by an interval of at most `left` (s), to its next event; its length, in which
/// `met` is as for find_interval.
double move(const Scene& scene, World& world, Workspace& work, double left, bool locate, bool& met,
            Stopwatch& watch) {
  begin_interval(world, work, world.time() + (world.step_length - left));
  if (locate) return find_interval(scene, world, work, left, met, watch);
  met = cross_interval(scene, world, work, left, watch);
  return left;
}

}  // namespace

void find_present_velocities(const Scene& scene, const World& world, double time, Workspace& work) {
  TimeSpan instant;
  instant.start = time;
  instant.kick = instant.lag = world.lag;
  apply_forces(scene, world, instant, work);
  for (const Part& part : work.parts.list) {
    if (!part.asleep) solve_present(scene, world, work, part);
  }
}

StepStatus advance(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  Stopwatch watch(times);
  Diagnostics& d = world.diagnostics;
  d.active_set_solves = 0;
  const std::int64_t fallbacks = d.fallbacks;
  int changes = changes_of_cables(world);
  const std::int64_t allowed =
      changes + most_changes + most_changes_a_body * static_cast<std::int64_t>(world.bodies.size());
  double left = world.step_length;
  int events = 0;
  // Velocities that the scene starts with need not fit its cables: they meet them at once.
  if (world.step == 0) strike_all(scene, world, work, 0.0, true);
  for (bool first = true; left > 0.0; first = false) {
    const double lag = world.lag;
    const bool locates = events < most_events;
    bool met = true;
    const double length = move(scene, world, work, left, locates, met, watch);
    if (!check_finite(scene, world)) return StepStatus::not_finite;
    lay_down_cables(world, work.parts);
    if (first && world.configuration.diagnostics) {
      d.energy += kinetic_energy(world, work.before, lag / (lag + 0.5 * length));
    }
    ++d.intervals;
    d.local_error = std::max(d.local_error, work.local_error);
    d.total_solves += d.active_set_solves;
    left = length < left ? left - length : 0.0;
    world.lag = 0.5 * length;
    const double now = work.start.time + length;
    const bool happened = !work.events.empty();
    if (!met) ++events;
    if (happened) {
      ++events;
      ++d.events;
      catch_up(scene, world, now, work);
      change_courses(world, work);
      if (changes_of_cables(world) > allowed) return fail_by_changes(world);
    }
    for (const Part& part : work.parts.list) {
      if (left == 0.0 && !part.asleep) note_rest(scene, work.parts, part, world);
    }
    detect_after_moving(scene, world, work, locates && !happened, times);
    watch = Stopwatch(times);
    empty_pinches(world, work.parts);
    const int before = changes;
    changes = changes_of_cables(world);
    const bool violated =
        !met || work.violated || changes != before || is_squeezed(world, work.parts);
    if (settle_end(scene, world, work, now, violated, happened, events <= most_rebounds, times)) {
      changes = changes_of_cables(world);
    }
    watch.lap(Stage::solve);
  }
  if (!scene.chains.empty())
    adapt_nodes(scene, world, work, world.time() + world.step_length, times);
  if (events > most_rebounds) ++d.clusters;
  d.fallbacks = std::min(d.fallbacks, fallbacks + 1);
  return StepStatus::ok;
}

}  // namespace pinchlab
