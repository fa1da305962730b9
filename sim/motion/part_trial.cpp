// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/part_trial.h"

#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/motion/missed.h"
#include "sim/motion/turning.h"
#include "sim/solve/active_set.h"
#include "sim/solve/forces.h"
#include "sim/solve/foresight.h"
#include "sim/solve/motors.h"
#include "sim/solve/passive.h"
#include "sim/solve/rows.h"
#include "sim/solve/solution.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

// Of a step: bodies move so little in it that only round-off would be corrected.
constexpr double shortest_corrected = 1e-6;

/// Everything that moves of a part, `length` seconds after the interval's start.
void place_part(World& world, Workspace& work, const Part& part, double length, bool begins) {
  const Start& start = work.start;
  for (const int number : bodies_of(work.parts, part)) {
    const auto b = index(number);
    if (!work.parts.immobile[b]) {
      world.position[b] = start.position[b] + length * world.velocity[b];
    }
    world.angle[b] = start.angle[b] + length * world.angular_velocity[b];
  }
  carry(world, carried_of(work.parts, part));
  for (const int c : cables_of(work.parts, part)) {
    CableState& cable = at(world.cables, c);
    if (part.slides) {
      const auto first = index(at(work.first_link, c));
      for (std::size_t i = 0; i < cable.links.size(); ++i) {
        cable.links[i].material = start.material[first + i] - length * cable.links[i].slip_speed;
      }
    }
    const bool moved = update_cable(world, cable, begins, is_known(work));
    work.spans_moved = work.spans_moved || moved;
  }
}

}  // namespace

void put_back(World& world, Workspace& work, const Part& part) {
  const Start& start = work.start;
  const auto put_body = [&](int body) {
    at(world.position, body) = at(start.position, body);
    at(world.velocity, body) = at(start.velocity, body);
    at(world.angle, body) = at(start.angle, body);
    at(world.angular_velocity, body) = at(start.angular_velocity, body);
  };
  for (const int body : bodies_of(work.parts, part)) put_body(body);
  for (const int shape : carried_of(work.parts, part)) put_body(shape);
  for (const int c : cables_of(work.parts, part)) {
    CableState& cable = at(world.cables, c);
    if (const int first = at(work.first_link, c); first >= 0) {
      for (std::size_t i = 0; i < cable.links.size(); ++i) {
        cable.links[i].material = start.material[index(first) + i];
        cable.links[i].slip_speed = start.slip[index(first) + i];
      }
    }
    update_cable(world, cable, false, is_known(work));
  }
}

namespace {

/// Solves and moves a part, with at most so many changes of what its motors do; whether its lengths
/// and gaps are exact then.
bool move_part(const Scene& scene, World& world, Workspace& work, Part& part, const TimeSpan& t,
               const Attempt& attempt, int changes_of_motors, IntervalTrial& trial,
               Stopwatch& watch) {
  PartSystem& s = at(work.systems, part.system);
  SolveScratch& set = work.solve;
  bool settled = solve_steadily(scene, world, work, part, t, changes_of_motors, watch);
  double last = infinity, before_last = infinity;
  const std::span<const int> bodies = bodies_of(work.parts, part);
  Diagnostics& d = world.diagnostics;
  for (int round = 0;; ++round) {
    if (round > 0) settled = solve_again(world, work.parts, part, s, set);
    if (set.froze) ++d.fallbacks;
    const double round_off = s.tolerance() / t.repair;  // m/s, over a step
    if (round > 0 && bends_too_far(world, bodies, work.linear_velocity, s.velocity, round_off)) {
      trial.missed = infinity;
      return false;
    }
    trial.settled = trial.settled && settled;
    trial.froze = trial.froze || set.froze;
    d.active_set_solves = std::max(d.active_set_solves, set.solves);
    store_solution(work.parts, part, s, set.capstan, t, world);
    part.slides = !set.capstan.runs.empty() || part.can_slip || !s.sleeves.empty();
    watch.lap(Stage::solve);
    place_part(world, work, part, t.length, attempt.begins && round == 0);
    watch.lap(Stage::move_bodies);
    // SHAKE's first correction is the curvature of the way, and the second what the constraints'
    // turning on that way makes of it: of the order of the interval's own error.
    const double missed = add_missed(world, work.parts, part, set, t, s, trial);
    const bool corrects = t.length >= shortest_corrected * t.repair;
    const bool follows = round < 2 && attempt.most_rounds > 0 && !s.carried.empty() && corrects;
    if (follows) follow_flow(scene, work.start, work.parts, part, t, s);
    watch.lap(Stage::update_segments);
    // Of what was foreseen there is nothing left but where it goes otherwise than foreseen.
    if (round == 1 || t.foreseen) trial.local_error = std::max(trial.local_error, missed);
    trial.curves = trial.curves || missed > s.tolerance();
    // Where another correction does not help, as on a cable that is as straight as can be, what the
    // next interval makes up for may stay; but of ropes, which follow_flow bends meanwhile. In so
    // short an interval there is nothing to correct but round-off.
    const bool helps = round < 2 || missed < 0.5 * before_last;
    const bool may_stay = !helps && s.carried.empty();
    const bool meets = missed <= (may_stay ? t.made_up : s.tolerance()) || !corrects;
    if (meets && !follows) {
      if (round > 0) trial.turned = turned_square(world, bodies, t.length, s);
      return true;
    }
    // Where states flip it may get worse for a round.
    trial.missed = std::max(trial.missed, missed / s.extent);
    trial.excess = std::max(trial.excess, missed / s.tolerance());
    trial.contradicts = trial.contradicts || (round > 0 && (!settled || set.contradicts));
    if (round == attempt.most_rounds || !settled || !helps) return false;
    before_last = last;
    last = missed;
    if (round == 0) work.linear_velocity = s.velocity;
  }
}

/// The same, with motors that are within their limits then. The first solution, whose constraints
/// are those of the interval's start, does not know half of the force that a curved way takes.
bool move_part(const Scene& scene, World& world, Workspace& work, Part& part, const TimeSpan& t,
               const Attempt& attempt, IntervalTrial& trial, Stopwatch& watch) {
  constexpr int most_turns = 3;  // each motor to its limit, back, and no third time
  PartSystem& s = at(work.systems, part.system);
  bool met = move_part(scene, world, work, part, t, attempt, most_motor_changes, trial, watch);
  for (int turn = 0; met && turn < most_turns && change_limited_motors(s); ++turn) {
    put_back(world, work, part);
    s.free_velocity = s.unconstrained;
    drive(s);
    trial = IntervalTrial{};
    met = move_part(scene, world, work, part, t, attempt, 0, trial, watch);
  }
  return met;
}

}  // namespace

IntervalTrial try_part(const Scene& scene, World& world, Workspace& work, Part& part,
                       const Attempt& attempt, Stopwatch& watch) {
  PartSystem& s = at(work.systems, part.system);
  const Pace pace = pace_of(world, work.parts, part);
  TimeSpan t;
  t.length = attempt.length;
  t.repair = world.step_length;
  t.lag = pace.lag;
  t.clamps = true;
  t.straight = attempt.most_rounds == 0;
  t.kick = pace.lag + 0.5 * t.length;
  t.start = work.start.time;
  apply_forces(scene, world, t, work.parts, part, s);
  watch.lap(Stage::apply_forces);
  t.made_up = s.reach;
  t.foreseen =
      attempt.foresees && s.carried.empty() && is_foreseen(pace, world.configuration.error, t);
  t.steady =
      pace.intervals >= 2 && !has_contacts(part) && world.configuration.solver == Solver::direct;
  t.reach = attempt.locates ? s.reach : infinity;
  IntervalTrial trial;
  trial.met = move_part(scene, world, work, part, t, attempt, trial, watch);
  trial.foreseen = t.foreseen;
  return trial;
}

}  // namespace pinchlab
