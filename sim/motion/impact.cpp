// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/impact.h"

#include <algorithm>

#include "base/at.h"
#include "sim/solve/motors.h"
#include "sim/solve/passive.h"
#include "sim/solve/rows.h"
#include "sim/solve/solution.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Whether a row is of a contact that may rebound.
bool may_rebound(const World& world, const PartSystem& s, const Row& row) {
  return row.kind == RowKind::normal && row.clearance <= s.reach &&
         restitution_of(world, at(world.contacts, row.index)) > 0.0;
}

/// The speed at which the fastest of them closes (m/s); 0 if none is faster than `least`.
double fastest_approach(const World& world, const PartSystem& s, double least) {
  double fastest = 0.0;
  for (int r = s.first_contact_row; index(r) < s.rows.size(); ++r) {
    if (!may_rebound(world, s, at(s.rows, r))) continue;
    const double approach = -row_speed(s, index(r));
    if (approach > std::max(fastest, least)) fastest = approach;
  }
  return fastest;
}

/// What closes slower than that is round-off (m/s).
double least_approach(const PartSystem& s) {
  constexpr double rounding = 1e-12;
  return rounding * greatest_speed(s.free_velocity);
}

/// Throws the rows' contacts back, those that close fastest first, each by its restitution; whether
/// any was. Velocities after it are the system's free ones.
bool throw_back(World& world, const Parts& parts, const Part& part, PartSystem& s,
                SolveScratch& set) {
  // What closes as fast but for round-off is thrown back at once, as both corners of a box that
  // falls flat: one after another the first would turn it, to a side of which nothing tells.
  constexpr double as_fast = 1.0 - 1e-9;
  // One blow a contact and neighbour is plenty; what is left then is stopped.
  const int most_blows = 4 * (static_cast<int>(s.rows.size()) - s.first_contact_row);
  const double least = least_approach(s);
  bool any = false;
  for (int blow = 0; blow < most_blows; ++blow) {
    const double fastest = fastest_approach(world, s, least);
    if (fastest == 0.0) break;
    for (int r = s.first_contact_row; index(r) < s.rows.size(); ++r) {
      Row& row = at(s.rows, r);
      if (row.kind != RowKind::normal) continue;
      const double speed = row_speed(s, index(r));
      row.on = may_rebound(world, s, row) && -speed >= as_fast * fastest;
      row.idle = !row.on;
      if (!row.on) continue;
      Contact& contact = at(world.contacts, row.index);
      row.bias = restitution_of(world, contact) * speed;
      contact.rebounds = any = true;
      contact.struck = world.step;
    }
    forget_flips(s);
    solve_passively(world, parts, part, s, set);
    // Where others must not come nearer, a rebound may cost more than there is.
    const bool made = makes_energy(s, set);
    for (Row& row : s.rows) {
      if (row.kind == RowKind::normal) row.bias = 0.0;
    }
    if (made) {
      forget_flips(s);
      solve_passively(world, parts, part, s, set);
    }
    s.free_velocity = s.velocity;
  }
  return any;
}

/// Lets nothing come nearer that is in touch. Whether the solve has settled.
bool stop(const World& world, const Parts& parts, const Part& part, bool rebounded, PartSystem& s,
          SolveScratch& set) {
  for (int r = s.first_contact_row; index(r) < s.rows.size(); ++r) {
    Row& row = at(s.rows, r);
    if (row.kind != RowKind::normal) continue;
    row.idle = row.clearance > s.reach;
    row.on = !row.idle && at(world.contacts, row.index).touching && !rebounded;
  }
  forget_flips(s);
  return solve_passively(world, parts, part, s, set);
}

}  // namespace

void strike(const Scene& scene, World& world, Workspace& work, const Part& part, bool rebounds) {
  PartSystem& s = at(work.systems, part.system);
  SolveScratch& set = work.solve;
  TimeSpan instant;
  instant.reach = s.reach;
  instant.clamps = true;
  instant.repair = world.step_length;
  Stopwatch untimed(nullptr);
  const double least = least_approach(s);
  const bool settled = solve_with_motors(scene, world, work, part, instant, untimed, [&] {
    for (const int c : contacts_of(work.parts, part)) at(world.contacts, c).rebounds = false;
    s.velocity = s.free_velocity;
    const bool rebounded = rebounds && throw_back(world, work.parts, part, s, set);
    return stop(world, work.parts, part, rebounded, s, set);
  });
  if (!settled) ++world.diagnostics.fallbacks;
  store_solution(work.parts, part, s, set.capstan, instant, world);
  // What another's blow lifts hops as well, and comes down at a time of its own: an interval that
  // begins with that and lasts longer would hold it down instead. What is over in next to no time
  // does not show, and without end there would be more of it where many lie on one another.
  constexpr double next_to_no_time = 1e-2;  // of a step
  const double hop =
      rebounds ? least + next_to_no_time * world.step_length * scene.gravity.norm() : infinity;
  for (std::size_t r = index(s.first_contact_row); r < s.rows.size(); ++r) {
    const Row& row = s.rows[r];
    if (row.kind != RowKind::normal) continue;
    Contact& contact = at(world.contacts, row.index);
    const double parting = row.on || row.clearance > s.reach ? 0.0 : row_speed(s, r);  // m/s
    contact.rebounds = parting > (contact.rebounds ? least : hop);
  }
}

}  // namespace pinchlab
