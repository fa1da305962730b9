// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/passive.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/parts.h"
#include "sim/solve/active_set.h"
#include "sim/solve/light_bodies.h"
#include "sim/solve/motors.h"
#include "sim/solve/rows.h"
#include "sim/solve/solve_scratch.h"
#include "sim/solve/sweeps.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Whether that follows without a sum: with A = J M^-1 J^T, where each impulse is an unknown of its
/// own, J v- = -bias - A p, and sum p (J v- + J v+) = -p A p - 2 p bias; unless impulses are so
/// large that what the solution leaves of these equations counts, on spans that hardly can give. Of
/// the bias the curvature of the way makes none: what the chord takes, or gives, the way does not.
bool cannot_make_energy(const PartSystem& s, const SolveScratch& set) {
  if (!set.direct) return false;
  const double round_off = s.reach / set.step_length;  // m/s
  // Of a row's equation, as a share of its own impulse's part: some units in its last place.
  constexpr double residual = 1e-15;
  return std::all_of(s.rows.begin(), s.rows.end(), [round_off](const Row& row) {
    return !row.on || (std::abs(row.bias - row.curved) <= round_off &&
                       residual * row.diagonal * std::abs(row.impulse) <= round_off);
  });
}

/// What counts as energy made (J), where the solver knows it but for round-off: of speeds, as a
/// share of what the rows have changed.
double least_energy(const SolveScratch& set) {
  constexpr double rounding = 1e-11;  // as makes_energy has it, of energies
  double energy = 0.0;
  for (const double way : set.dual.way) energy += way * way;
  return rounding * (energy + std::abs(set.dual.energy));
}

/// Leaves the velocities as they are where all impulses are round-off of the speeds that things
/// have, as those of a blow by which nothing meets; whether they are. They may go with what slides
/// as well as against it, which is no reason to hold it.
bool leaves_out_round_off(PartSystem& s) {
  constexpr double rounding = 1e-7;  // of speeds: far more than round-off, and next to nothing
  double fastest = 0.0, change = 0.0;
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const RowBodies& bodies = s.bodies[r];
    fastest = std::max({fastest, std::abs(bodies.ja.dot(s.free_velocity[index(bodies.a)])),
                        std::abs(bodies.jb.dot(s.free_velocity[index(bodies.b)]))});
    change = std::max(change, s.rows[r].diagonal * std::abs(s.rows[r].impulse));
  }
  if (change > rounding * fastest) return false;
  s.velocity = s.free_velocity;
  for (Row& row : s.rows) row.impulse = 0.0;
  return true;
}

/// Of the bodies' motion before the rows' impulses (J, twice).
double energy_before(const PartSystem& s) {
  double energy = 0.0;
  const auto add = [&energy](double velocity, double mobility) {
    if (mobility > 0.0) energy += velocity * velocity / mobility;
  };
  for (std::size_t i = 0; i < s.mobility.size(); ++i) {
    add(s.free_velocity[i].x(), s.mobility[i].xx);
    add(s.free_velocity[i].y(), s.mobility[i].yy);
    add(s.free_velocity[i].z(), s.mobility[i].angular);
  }
  return energy;
}

}  // namespace

bool makes_energy(const PartSystem& s, const SolveScratch& set) {
  if (cannot_make_energy(s, set)) return false;
  if (set.by_dual) return set.dual.energy > least_energy(set);
  double made = 0.0, impulse = 0.0, made_up = 0.0, fastest = 0.0;  // J, J s/m, J, m/s; twice
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const Row& row = s.rows[r];
    if (row.impulse == 0.0) continue;
    if (row.compliance > 0.0) return false;
    const RowBodies& bodies = s.bodies[r];
    const auto a = index(bodies.a), b = index(bodies.b);
    const double of_a = bodies.ja.dot(s.free_velocity[a] + s.velocity[a]);
    const double of_b = bodies.jb.dot(s.free_velocity[b] + s.velocity[b]);
    const double of_third =
        speed_of_third(s, r, s.free_velocity) + speed_of_third(s, r, s.velocity);
    // A middle that slides has left the place to which a way bends it back.
    const bool slides = row.kind == RowKind::pinch_middle && row.slip != Slip::stick;
    const double curved = slides ? 0.0 : row.curved;
    made += row.impulse * (of_a + of_b + of_third + 2.0 * curved);
    impulse += std::abs(row.impulse);
    made_up += std::abs(row.impulse) *
               std::min(std::abs(row.bias - row.curved), s.reach / set.step_length);
    fastest = std::max({fastest, std::abs(of_a), std::abs(of_b), std::abs(of_third)});
  }
  // Ten times active_set.cpp's tolerance: what that has let pass makes no energy.
  const double rounding = 1e-11 * fastest + 1e-14 * s.extent / set.step_length;
  if (made <= impulse * rounding + 2.0 * made_up) return false;
  // Impulses that are nothing but round-off may go with what slides as well as against it, and a
  // row's speed is the difference of its bodies'.
  constexpr double residual = 1e-14;  // a hundred units in the last place
  return !(made <= residual * energy_before(s));
}

bool solve_passively(const World& world, const Parts& parts, const Part& part, PartSystem& s,
                     SolveScratch& set) {
  bool settled = solve_direct(world, parts, part, s, set);
  if (set.by_dual && makes_energy(s, set)) {
    forget_flips(s);
    set.repairs = false;
    settled = solve_direct(world, parts, part, s, set);
    set.repairs = true;
  }
  if (!makes_energy(s, set)) return settled;
  if (leaves_out_round_off(s)) return settled;
  const double fastest = std::max(greatest_speed(s.velocity), greatest_speed(s.free_velocity));
  forget_flips(s);
  for (Friction& friction : s.frictions) friction.dropped = true;
  for (SleevePlace& sleeve : s.sleeves) sleeve.dropped = true;
  const auto is_frictionless = [](const Run& run) { return run.frictionless; };
  const std::vector<Run>& runs = set.capstan.runs;
  set.held = std::any_of(runs.begin(), runs.end(), is_frictionless);
  Part held = part;
  held.may_slide = set.held;
  const bool held_settled = solve_direct(world, parts, held, s, set);
  set.held = false;
  // A motor may wind in what cannot slide any more, and throw what hardly bends the cable.
  const bool throws = !s.motors.empty() && greatest_speed(s.velocity) > thrown * fastest;
  if (!throws && !makes_energy(s, set)) return held_settled;
  for (Row& row : s.rows) row.impulse = 0.0;
  sweep_rows(s, set);
  set.froze = true;
  return false;
}

bool solve_steadily(const Scene& scene, const World& world, Workspace& work, const Part& part,
                    const TimeSpan& t, int changes_of_motors, Stopwatch& watch) {
  PartSystem& s = at(work.systems, part.system);
  const bool steadies = steady_light_bodies(world, work.parts, part, t.kick, s);
  const auto solve = [&] {
    return solve_with_motors(
        scene, world, work, part, t, watch,
        [&] { return solve_passively(world, work.parts, part, s, work.solve); }, changes_of_motors);
  };
  const bool settled = solve();
  if (!steadies || !gains_by_steadying(world, work.parts, part, s)) return settled;
  if (!s.motors.empty()) s.free_velocity = s.unconstrained;
  release_light_bodies(s);
  drive(s);
  return solve();
}

}  // namespace pinchlab
