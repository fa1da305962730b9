// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/advance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>

#include "base/at.h"
#include "sim/cable/creep.h"
#include "sim/cable/strung.h"
#include "sim/detect/detect.h"
#include "sim/diagnostics.h"
#include "sim/motion/adapt_nodes.h"
#include "sim/motion/catch_up.h"
#include "sim/motion/clearance.h"
#include "sim/motion/events.h"
#include "sim/motion/impact.h"
#include "sim/motion/interval.h"
#include "sim/motion/repair.h"
#include "sim/solve/forces.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

// Of a step's events: what comes after most_rebounds does not rebound, so that what bounces without
// end lies still for the rest of those that are located.
constexpr int most_rebounds = 24;
// Beside these: friction that turns round and back without end is a jam's.
constexpr int most_jumps = 8;

// Of links, in one step: 500, and ten a body. Where more come and go, spans are being wound round
// what they are in without end, each change making more, and steps last minutes.
constexpr std::int64_t most_changes = 500, most_changes_a_body = 10;

/// Cables, contacts, pinches and parts for where things are now. `pairs_stand` as in detect.h.
void detect_present(const Scene& scene, World& world, Workspace& work, bool pairs_stand,
                    StageTimes* times) {
  find_what_may_meet(scene, world, work, pairs_stand, times);
  bring_together(scene, world, work);
  find_what_meets(scene, world, work, times);
  if (work.parts.divided) share_paces(work.parts_before, work.parts, world);
  if (work.parts.changed) list_parts(work.parts, work.neighbourhoods);
}

/// Forces of an instant at the positions' time.
void apply_no_forces(const Scene& scene, const World& world, const Part& part, double time,
                     Workspace& work) {
  TimeSpan instant;
  instant.start = time;
  apply_forces(scene, world, instant, work.parts, part, at(work.systems, part.system));
}

/// Whether a contact is, that can give.
bool is_squeezed(const World& world, const Parts& parts, const Part& part) {
  return part.can_move && std::ranges::any_of(contacts_of(parts, part), [&](int number) {
           const Contact& c = at(world.contacts, number);
           // By more than what solves of other events leave, each within a reach.
           return c.gap < c.target - 10.0 * reach_at(world, c.a) && can_give(world, c);
         });
}

/// Contacts have been found for twice what bodies do in a step at their speeds, and outlines as
/// they turn as well. Strikes a part; whether that has made a body of it faster still.
bool strike_and_hasten(const Scene& scene, World& world, Workspace& work, const Part& part,
                       double time, bool rebounds) {
  const std::span<const int> bodies = bodies_of(work.parts, part);
  const auto speeds = [&world](int b) {
    const double speed = at(world.velocity, b).norm();
    return std::array{speed,
                      speed + at(world.bodies, b).radius * std::abs(at(world.angular_velocity, b))};
  };
  work.speeds.clear();
  for (const int body : bodies) std::ranges::copy(speeds(body), std::back_inserter(work.speeds));
  apply_no_forces(scene, world, part, time, work);
  strike(scene, world, work, part, rebounds);
  const double slow = scene.gravity.norm() * world.step_length;
  const double* before = work.speeds.data();
  for (const int body : bodies) {
    for (const double speed : speeds(body)) {
      if (speed > 2.0 * *before++ + slow) return true;
    }
  }
  return false;
}

/// Whether links of a part's cables have come or gone since World::changes was `before`.
bool has_changed(const World& world, const Parts& parts, const Part& part, int before) {
  if (world.changes == before) return false;
  return std::ranges::any_of(cables_of(parts, part),
                             [&](int c) { return at(world.cables, c).changed_at > before; });
}

/// Puts right in positions what an interval of these parts has left, and then the velocities to fit
/// them; whether contacts must be found anew for these. Links had come or gone `changes` times
/// when the interval before was settled.
bool settle_end(const Scene& scene, World& world, Workspace& work, std::span<const int> parts,
                int changes) {
  const Neighbourhoods& near = work.neighbourhoods;
  const bool divided = !near.of_body.empty();
  bool anew = false;
  Neighbourhood own;
  for (const int p : parts) {
    Part& part = at(work.parts.list, p);
    if (divided) own = course_of(near, work.parts, part);
    const Neighbourhood& course = divided ? own : near.list.front();
    const bool violated = course.violated || has_changed(world, work.parts, part, changes) ||
                          is_squeezed(world, work.parts, part);
    if (!violated && !course.happened) continue;
    if (course.happened) catch_up(scene, world, part, course.time, work);  // if it has crossed some
    apply_no_forces(scene, world, part, course.time, work);
    const bool repaired = repair(scene, world, work, part);
    if (repaired) {
      catch_up(scene, world, part, course.time, work);
      anew = true;  // bodies have moved
    }
    if (!course.happened && !repaired) continue;
    const bool rebounds = course.events <= most_rebounds;
    anew = strike_and_hasten(scene, world, work, part, course.time, rebounds) || anew;
  }
  return anew;
}

void strike_all(const Scene& scene, World& world, Workspace& work, double time, bool rebounds) {
  for (const int p : work.neighbourhoods.parts.items) {
    const Part& part = at(work.parts.list, p);
    apply_no_forces(scene, world, part, time, work);
    strike(scene, world, work, part, rebounds);
  }
}

/// Makes cables of nodes finer and coarser.
void adapt_nodes(const Scene& scene, World& world, Workspace& work, double time,
                 StageTimes* times) {
  if (wants_other_nodes(scene, world, work)) {
    Neighbourhoods& near = work.neighbourhoods;
    catch_up(scene, world, near.parts.items, time, work);
    std::fill(world.pace.begin(), world.pace.end(), Pace{});
    const double before = kinetic_energy(world);
    change_nodes(scene, world, work);
    detect_present(scene, world, work, false, times);
    strike_all(scene, world, work, time, false);
    world.diagnostics.node_losses += before - kinetic_energy(world);
  }
  follow_chains(scene, world, work);
}

/// Puts nodes of cables that run over bodies back where rims have given them off, and carries along
/// those on rims.
void give_off(const Scene& scene, World& world, Workspace& work, double time, StageTimes* times) {
  const int changes = world.changes;
  for (const int c : world.strung) {
    CableState& cable = at(world.cables, c);
    if (is_idle(work.parts, index(c)) || !has_given_off(world, cable)) continue;
    catch_up(scene, world, at(work.parts.list, at(work.parts.of_cable, c)), time, work);
    give_off_nodes(world, cable);
  }
  for (const int c : world.strung) {
    if (!is_idle(work.parts, index(c))) carry_wound_nodes(world, at(world.cables, c));
  }
  if (world.changes == changes) return;
  world.diagnostics.node_changes += world.changes - changes;
  work.broad_phase.boxes.clear();  // for bodies with other outlines
  detect_present(scene, world, work, false, times);
  for (const int p : work.neighbourhoods.parts.items) {
    const Part& part = at(work.parts.list, p);
    if (!has_changed(world, work.parts, part, changes)) continue;
    apply_no_forces(scene, world, part, time, work);
    strike(scene, world, work, part, false);
  }
}

StepStatus fail_by_changes(World& world) {
  world.failure = fmt::format(
      "step {} (t = {} s): cables meet and leave bodies without end; move apart what they are in",
      world.step, world.time());
  return StepStatus::failed;
}

/// Whether forces jump by these, and nothing meets or comes off.
bool only_jump(const std::vector<Happening>& events) {
  bool any = false;
  for (const Happening& event : events) {
    if (event.clearance > event.reach) continue;
    if (event.kind < EventKind::halts) return false;
    any = true;
  }
  return any;
}

/// What moves by the next interval of neighbourhood `n`.
Movers movers_of(const Neighbourhoods& near, int n) {
  const Neighbourhood& course = at(near.list, n);
  return {parts_of(near, n), course.crept, course.jumps < most_jumps};
}

/// Whether the velocities of a part's bodies are, by their sum, which zero times is zero then.
bool is_finite(const World& world, const Parts& parts, const Part& part) {
  double sum = 0.0;
  for (const int b : bodies_of(parts, part)) {
    sum += at(world.velocity, b).sum() + at(world.angular_velocity, b);
  }
  return 0.0 * sum == 0.0;
}

/// What happens at the end of neighbourhood `n`'s interval.
void change_at_end(const Scene& scene, World& world, Workspace& work, int n) {
  Neighbourhoods& near = work.neighbourhoods;
  Neighbourhood& course = at(near.list, n);
  ++(only_jump(work.events) ? course.jumps : course.events);
  ++world.diagnostics.events;
  // What crosses events leaves nodes where rims should have had them: spans next to nothing long,
  // whose turning has no bound.
  if (course.located) catch_up(scene, world, parts_of(near, n), course.time, work);
  change_courses(world, work);
  if (near.divided) find_pairs_of_interval(scene, world, work);
}

/// Kinetic energy (J) of these at the time of their positions before an interval of `length` (s).
double kinetic_energy(const World& world, const Workspace& work, std::span<const int> parts,
                      double length) {
  double energy = 0.0;
  for (const int p : parts) {
    for (const int body : bodies_of(work.parts, at(work.parts.list, p))) {
      energy += kinetic_energy(world, work.before, length, body);
    }
    for (const int c : cables_of(work.parts, at(work.parts.list, p))) {
      energy += kinetic_energy_of_sleeves(world, work.before, length, c);
    }
  }
  return energy;
}

/// An interval of neighbourhood `n` is done, of `length` (s), the `first` of the step or not; `met`
/// as for shorten_interval. Whether all velocities are finite.
bool finish_interval(const Scene& scene, World& world, Workspace& work, int n, double length,
                     bool met, bool first) {
  const std::span<const int> parts = parts_of(work.neighbourhoods, n);
  if (first && world.configuration.diagnostics) {
    world.diagnostics.energy += kinetic_energy(world, work, parts, length);
  }
  Neighbourhood& course = at(work.neighbourhoods.list, n);
  const bool even = met && course.located && work.events.empty();
  bool balances = false;  // stretches: no time that round-off leaves of a step is an interval
  for (const int p : parts) {
    const Part& part = at(work.parts.list, p);
    if (!is_finite(world, work.parts, part) && !check_finite(scene, world)) return false;
    balances = balances || !at(work.systems, part.system).elastic_ends.empty();
    if (part.creeps) {
      for (const int c : cables_of(work.parts, part)) lay_down(world, at(world.cables, c), length);
    }
    note_ways(world, work, part, at(work.trials, p), length, even);
  }
  course.time = work.start.time + length;
  const double left = course.left - length, rounding = 1e-12 * world.step_length;  // s
  course.left = left > (balances ? rounding : 0.0) ? left : 0.0;
  course.moved = true;
  course.happened = !work.events.empty();
  course.violated = !met || work.trial.violated;
  if (!met) ++course.events;
  if (course.happened) change_at_end(scene, world, work, n);
  return true;
}

void set_waiting(Parts& parts, std::span<const int> of, bool waits) {
  for (const int p : of) at(parts.list, p).waits = waits;
}

/// What is to be done in a step's next round.
struct Round {
  bool first = true;       // of the step
  bool may_divide = true;  // the step into neighbourhoods
};

bool move_each(const Scene& scene, World& world, Workspace& work, Stopwatch& watch);

/// Moves a neighbourhood by less than the interval of `length` (s) that was just tried in vain; how
/// long. `met` as for shorten_interval.
double shorten(const Scene& scene, World& world, Workspace& work, Movers& movers,
               Neighbourhood& course, double length, bool& met, Stopwatch& watch) {
  constexpr double next_to_nothing = 1e-2;  // halvings for other reasons end at a 32nd
  const double shorter = shorten_interval(scene, world, work, movers, length, met, watch);
  course.crept = work.events.empty() && shorter < next_to_nothing * length;
  if (!movers.jumps) course.jumps = most_jumps;
  return shorter;
}

/// Moves a neighbourhood by an interval, to its next event or to the end of the step; where that is
/// not the whole step, and `may_divide`, its parts are divided first. Whether speeds are finite.
bool move(const Scene& scene, World& world, Workspace& work, int n, const Round& round,
          Stopwatch& watch) {
  Neighbourhoods& near = work.neighbourhoods;
  Neighbourhood& course = at(near.list, n);
  Movers movers = movers_of(near, n);
  near.moving = movers.parts;
  begin_interval(world, work, movers, world.time() + (world.step_length - course.left));
  // What may be divided into neighbourhoods is tried as a whole.
  double length = course.left;
  course.located = course.events < located_events(world);
  if (!round.may_divide) {
    length = length_to_try(world, work, movers.parts, length, course.located);
  }
  bool met = true;
  course.crept = false;
  if (!course.located) {
    met = cross_interval(scene, world, work, movers, length, watch);
    for (const int p : movers.parts) find_overrun_nodes(world, work, p);
    if (near.divided) find_pairs_of_interval(scene, world, work);
  } else if (!try_whole_interval(scene, world, work, movers, length, watch)) {
    if (round.may_divide && divide(scene, world, work)) return move_each(scene, world, work, watch);
    length = shorten(scene, world, work, movers, course, length, met, watch);
  }
  return finish_interval(scene, world, work, n, length, met, round.first);
}

/// Moves every neighbourhood that has not come to the end of the step by an interval, while all
/// others wait. Whether all velocities are finite.
bool move_one_by_one(const Scene& scene, World& world, Workspace& work, const Round& round,
                     Stopwatch& watch) {
  const Neighbourhoods& near = work.neighbourhoods;
  for (int n = 0; index(n) < near.list.size(); ++n) {
    if (at(near.list, n).left == 0.0) continue;
    set_waiting(work.parts, parts_of(near, n), false);
    if (!move(scene, world, work, n, round, watch)) return false;
    set_waiting(work.parts, parts_of(near, n), true);
  }
  return true;
}

/// A step that has just been divided, as something happens in it: neighbourhoods in which nothing
/// does have come to its end, others go on as if they had been tried alone.
bool move_each(const Scene& scene, World& world, Workspace& work, Stopwatch& watch) {
  Neighbourhoods& near = work.neighbourhoods;
  Diagnostics& d = world.diagnostics;
  keep_start(world, work);
  for (const Happening& event : work.events) {
    const bool hits = event.kind == EventKind::hit;
    near.crossed = near.crossed || (hits && near.separate_from_cable(event.body, event.cable));
  }
  list_events(work, near);
  work.tried_events.swap(work.events);
  d.fallbacks = work.start.fallbacks;
  for (int n = 0; index(n) < near.list.size(); ++n) {
    Neighbourhood& course = at(near.list, n);
    if (course.left == 0.0) continue;
    Movers movers = movers_of(near, n);
    const auto events =
        slice(near.events.items, at(near.events.begin, n), at(near.events.begin, n + 1));
    work.events.clear();
    for (const int e : events) work.events.push_back(at(work.tried_events, e));
    work.trial = trial_of(work, movers.parts);
    work.start.fallbacks = d.fallbacks;
    if (work.trial.froze) ++d.fallbacks;
    near.moving = movers.parts;
    course.located = true;
    double length = course.left;
    bool met = true;
    set_waiting(work.parts, movers.parts, false);
    if (!events.empty() || !is_sound(world, work.trial, length)) {
      length = shorten(scene, world, work, movers, course, length, met, watch);
    }
    if (!finish_interval(scene, world, work, n, length, met, true)) return false;
    set_waiting(work.parts, movers.parts, true);
  }
  return true;
}

/// The next round: every neighbourhood that has not come to the end of the step moves by an
/// interval. Whether all velocities are finite.
bool move_all(const Scene& scene, World& world, Workspace& work, const Round& round,
              Stopwatch& watch) {
  Neighbourhoods& near = work.neighbourhoods;
  work.released.clear();
  work.spans_moved = false;
  for (Neighbourhood& course : near.list) {
    course.moved = course.happened = course.violated = false;
  }
  if (near.list.size() == 1) return move(scene, world, work, 0, round, watch);
  find_pairs(scene, world, work);  // links have come and gone since
  for (Part& part : work.parts.list) part.waits = true;
  return move_one_by_one(scene, world, work, round, watch);
}

bool is_left(const Neighbourhoods& near) {
  return std::ranges::any_of(near.list, [](const Neighbourhood& c) { return c.left > 0.0; });
}

/// Settles the ends of the intervals of this round; as settle_end.
bool settle_ends(const Scene& scene, World& world, Workspace& work, int changes) {
  const Neighbourhoods& near = work.neighbourhoods;
  if (!near.divided) return settle_end(scene, world, work, near.parts.items, changes);
  bool anew = false;
  for (int n = 0; index(n) < near.list.size(); ++n) {
    if (!at(near.list, n).moved) continue;
    anew = settle_end(scene, world, work, parts_of(near, n), changes) || anew;
  }
  return anew;
}

/// What follows an interval: cables, contacts and pinches for where things are now, and velocities
/// that fit them. Returns how many times links have come or gone by then; they had `changes` times.
int settle(const Scene& scene, World& world, Workspace& work, int changes, StageTimes* times) {
  Neighbourhoods& near = work.neighbourhoods;
  bool pairs_stand = true;
  for (int n = 0; index(n) < near.list.size(); ++n) {
    const Neighbourhood& course = at(near.list, n);
    if (!course.moved) continue;
    pairs_stand = pairs_stand && course.located && !course.happened;
    if (course.left > 0.0) continue;
    for (const int p : parts_of(near, n)) {
      note_rest(scene, work.parts, at(work.parts.list, p), world);
    }
  }
  if (near.divided) {
    near.divided = is_left(near);
    list_parts(work.parts, near);
  }
  detect_present(scene, world, work, pairs_stand, times);
  Stopwatch watch(times);
  refill_pinches(world, work.parts);
  // What has been moved, or thrown, may meet cables, and these need room.
  constexpr int most_times = 3;
  for (int k = 0; k < most_times && settle_ends(scene, world, work, changes); ++k) {
    watch.lap(Stage::solve);
    changes = world.changes;
    detect_present(scene, world, work, false, times);
    watch = Stopwatch(times);
    for (Neighbourhood& course : near.list) course.happened = course.violated = false;
  }
  watch.lap(Stage::solve);
  return world.changes;
}

}  // namespace

StepStatus advance(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  Stopwatch watch(times);
  Diagnostics& d = world.diagnostics;
  int most_solves = 0;
  const std::int64_t fallbacks = d.fallbacks;
  int changes = world.changes;
  const std::int64_t allowed =
      changes + most_changes + most_changes_a_body * static_cast<std::int64_t>(world.bodies.size());
  const Neighbourhoods& near = work.neighbourhoods;
  put_together(world, work.parts, work.neighbourhoods);
  // Velocities that the scene starts with need not fit its cables: they meet them at once.
  if (world.step == 0) strike_all(scene, world, work, 0.0, true);
  Round round;
  while (is_left(near)) {
    d.active_set_solves = 0;
    if (!move_all(scene, world, work, round, watch)) return StepStatus::failed;
    ++d.intervals;
    d.total_solves += d.active_set_solves;
    most_solves = std::max(most_solves, d.active_set_solves);
    if (world.changes > allowed) return fail_by_changes(world);
    if (!near.crossed) changes = settle(scene, world, work, changes, times);
    watch = Stopwatch(times);
    round.first = near.crossed;
    round.may_divide = false;
    if (!near.crossed) continue;
    take_back(world, work);
    changes = world.changes;
  }
  const double end = world.time() + world.step_length;
  if (!scene.chains.empty() || !world.strung.empty()) adapt_nodes(scene, world, work, end, times);
  if (!world.strung.empty()) give_off(scene, world, work, end, times);
  const bool clusters =
      std::any_of(near.list.begin(), near.list.end(),
                  [](const Neighbourhood& course) { return course.events > most_rebounds; });
  if (clusters) ++d.clusters;
  d.active_set_solves = most_solves;
  d.fallbacks = std::min(d.fallbacks, fallbacks + 1);
  return StepStatus::ok;
}

}  // namespace pinchlab
