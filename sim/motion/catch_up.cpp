// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/catch_up.h"

#include "base/at.h"
#include "sim/compound.h"
#include "sim/solve/forces.h"
#include "sim/solve/motors.h"
#include "sim/solve/passive.h"
#include "sim/solve/rubbing.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

void find_present_velocities(const Scene& scene, const World& world, const Part& part, double time,
                             Workspace& work) {
  PartSystem& s = at(work.systems, part.system);
  TimeSpan instant;
  instant.start = time;
  instant.kick = instant.lag = pace_of(world, work.parts, part).lag;
  instant.held_only = true;
  apply_forces(scene, world, instant, work.parts, part, s);
  // With what bears force now.
  TimeSpan t;
  t.repair = world.step_length;
  t.kick = t.lag = instant.lag;
  t.reach = s.reach;
  t.held_only = t.clamps = true;
  Stopwatch untimed(nullptr);
  solve_steadily(scene, world, work, part, t, most_motor_changes, untimed);
}

void catch_up(const Scene& scene, World& world, const Part& part, double time, Workspace& work) {
  if (pace_of(world, work.parts, part).lag == 0.0) return;
  for (const int c : contacts_of(work.parts, part)) {
    if (Contact& contact = at(world.contacts, c); contact.touching) measure(world, contact);
  }
  find_present_velocities(scene, world, part, time, work);
  const PartSystem& s = at(work.systems, part.system);
  const std::span<const int> bodies = bodies_of(work.parts, part);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    at(world.velocity, bodies[i]) = s.velocity[i].head<2>();
    at(world.angular_velocity, bodies[i]) = s.velocity[i].z();
  }
  carry(world, carried_of(work.parts, part));
  if (!s.sleeves.empty()) store_rubbing(s, world);
  set_pace(world, work.parts, part, {});
}

void catch_up(const Scene& scene, World& world, std::span<const int> parts, double time,
              Workspace& work) {
  for (const int p : parts) catch_up(scene, world, at(work.parts.list, p), time, work);
}

void bring_together(const Scene& scene, World& world, Workspace& work) {
  Neighbourhoods& near = work.neighbourhoods;
  for (int n = 0; index(n) < near.list.size(); ++n) {
    if (parts_of(near, n).size() < 2) continue;
    // Those that catch up may have become unlike others, and faster.
    for (find_unlike(scene, world, work, n); !near.unlike.empty();
         find_unlike(scene, world, work, n)) {
      catch_up(scene, world, near.unlike, at(near.list, n).time, work);
    }
  }
}

}  // namespace pinchlab
