// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/interval.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/waves.h"
#include "sim/motion/events.h"
#include "sim/motion/jumps.h"
#include "sim/motion/part_trial.h"
#include "sim/motion/turning.h"
#include "sim/motion/vanishing.h"
#include "sim/solve/elastic.h"
#include "sim/solve/foresight.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

// Of a step, that an allowed error divides it into: far below what any that is asked for needs.
constexpr double shortest = 1e-4;
// So short an interval turns hardly anything far; where it does, shorter ones would as well, but
// for nodes, which a jerk whips about in far less.
constexpr double shortest_for_turns = 1.0 / 32.0;
constexpr double most_missed = 1e-6;  // of a part's extent, by friction that cycles: nobody sees it
constexpr int most_trials = 60;       // of an interval's length, which has 53 bits to be halved for
constexpr int most_halvings = 5;      // of one that does not converge: on a 32nd ways hardly bend

/// omega^2 (1/s^2) of the fastest wave on a part's cables with mass that steps are divided for.
double wave_on(const World& world, const Parts& parts, const Part& part) {
  if (!part.has_mass) return 0.0;
  double fastest = 0.0;
  for (const int c : cables_of(parts, part)) {
    fastest = std::max(fastest, wave_of(world, at(world.cables, c)));
  }
  return fastest;
}

void add(const IntervalTrial& one, IntervalTrial& all) {
  all.met &= one.met;
  all.settled &= one.settled;
  all.froze |= one.froze;
  all.violated |= one.violated;
  all.contradicts |= one.contradicts;
  all.missed = std::max(all.missed, one.missed);
  all.excess = std::max(all.excess, one.excess);
  all.local_error = std::max(all.local_error, one.local_error);
  all.longest = std::min(all.longest, one.longest);
  all.wave = std::max(all.wave, one.wave);
  all.turned = std::max(all.turned, one.turned);
}

/// Tries an interval from where the last began: Workspace::trial, and what has happened in it.
void try_interval(const Scene& scene, World& world, Workspace& work, const Movers& movers,
                  const Attempt& attempt, Stopwatch& watch) {
  work.trial = IntervalTrial{};
  work.trials.resize(work.parts.list.size());
  begin_trial(work);
  for (const int p : movers.parts) {
    Part& part = at(work.parts.list, p);
    IntervalTrial& trial = at(work.trials, p);
    const double longest =
        attempt.locates ? longest_interval(world, work.parts, {&p, 1}) : infinity;
    const std::int64_t fallbacks = world.diagnostics.fallbacks;
    trial = try_part(scene, world, work, part, attempt, watch);
    if (trial.foreseen && !trial.met) {
      put_back(world, work, part);
      world.diagnostics.fallbacks = fallbacks;
      trial = try_part(scene, world, work, part, {attempt.length}, watch);
    }
    trial.longest = longest;
    trial.wave = wave_on(world, work.parts, part);
    add(trial, work.trial);
    if (!attempt.locates) continue;
    find_catches(world, work, p);
    find_gone_links(world, work, p);
    if (movers.jumps && may_jump(part, at(work.systems, part.system))) {
      find_jumps(scene, world, work, p, attempt.length);
    }
  }
  if (attempt.locates) find_span_hits(scene, world, work);
  for (Happening& event : work.events) {
    if (!event.seen) event.clearance = infinity;
  }
}

/// Tries an interval from the same start again.
void try_again(const Scene& scene, World& world, Workspace& work, const Movers& movers,
               const Attempt& attempt, Stopwatch& watch) {
  go_back(world, work, movers.parts);
  try_interval(scene, world, work, movers, attempt, watch);
}

/// Whether nodes swing faster than a trial of that length (s) has followed.
bool is_outrun(const World& world, const IntervalTrial& trial, double length) {
  return trial.wave > 0.0 && !follows(world, trial.wave, length);
}

/// The share of an interval that is tried next where `wanted` would do. No less than a tenth at
/// once, as what that is by was found with the long one; and so much less that a trial is worth its
/// cost.
double next_share(double wanted) {
  return std::clamp(wanted, 0.1, 0.7);
}

/// The share of its length that a trial is to have which turns what bears force too far; 1 after
/// any other, and where it has come down to the shortest.
double share_for_turns(const World& world, const IntervalTrial& trial, double length) {
  const double least = trial.wave > 0.0 ? shortest_followed : shortest_for_turns;
  if (trial.turned <= most_turned || length <= least * world.step_length) return 1.0;
  return std::sqrt(most_turned / trial.turned);
}

/// The length (s) to try next after a trial of `length` that errs by more than the scene allows, or
/// turns what bears force too far; the same after any other, and where it has come down to the
/// shortest.
double sound_length(const World& world, const IntervalTrial& trial, double length) {
  const double allowed = share_of_error * world.configuration.error;
  double share = share_for_turns(world, trial, length);
  if (allowed > 0.0 && trial.met && trial.local_error > allowed &&
      length > shortest * world.step_length) {
    share = std::min(share, 0.8 * std::cbrt(allowed / trial.local_error));
  }
  return share < 1.0 ? next_share(share) * length : length;
}

/// The share of its length that an interval which was not met is to be tried with again. A way that
/// bends misses a quarter at half of the length; mostly its corrections converge soon. But a body
/// that comes upon a cable as straight as it can be, which cannot give, is only held once it is so
/// far in that the cable's directions tell, and lengths are exact only if that is next to nothing:
/// an interval is taken up to there. Another in succession would not help.
double share_to_try(const IntervalTrial& trial, const Movers& movers) {
  // No less than what corrections can tell (part_trial.cpp), and of the share that would just
  // do somewhat less, lest the next trial misses by a hair.
  constexpr double half = 0.5, least = 1e-6, safety = 0.7;
  if (!trial.contradicts || movers.crept || !(trial.excess < infinity)) return half;
  return std::clamp(safety / std::sqrt(trial.excess), least, half);
}

/// Moves by the longest interval of at most `length`, which was just tried, that is exact at its
/// end, follows all waves and errs by no more than the scene allows, whatever happens in it.
/// Returns its length.
double find_sound_interval(const Scene& scene, World& world, Workspace& work, const Movers& movers,
                           double length, Stopwatch& watch) {
  const IntervalTrial& trial = work.trial;
  const auto again = [&](int most_rounds) {
    work.events.clear();
    try_again(scene, world, work, movers, {length, most_rounds}, watch);
  };
  const auto misses = [&trial, &movers] {
    const bool contradicts = trial.contradicts && !movers.crept;
    return !trial.met && (trial.settled || contradicts || trial.missed > most_missed);
  };
  if (length > trial.longest) {
    length = trial.longest;
    again(shake_rounds);
  }
  double whole = length;  // before the first halving
  for (int halvings = 0;;) {
    if (is_outrun(world, trial, length)) {
      length *= next_share(interval_for(world, trial.wave) / length);
      again(shake_rounds);
      if (halvings == 0) whole = length;
      continue;
    }
    if (const double sound = sound_length(world, trial, length); sound < length) {
      length = sound;
      again(shake_rounds);
      if (halvings == 0) whole = length;
      continue;
    }
    if (!misses() || halvings++ == most_halvings) break;
    const double missed = trial.missed;
    const double share = share_to_try(trial, movers);
    length *= share;
    again(shake_rounds);
    // What misses as great a share contradicts itself, as a motor that turns against a jammed cable
    // does: no interval is short enough.
    if (misses() && trial.missed < infinity && trial.missed > 0.8 * share * missed) {
      length = whole;
      break;
    }
  }
  // The linear solution is sound at least; what it misses is repaired.
  if (!trial.met && (trial.settled || length == whole)) {
    again(0);
    work.trial.met = false;
  }
  return length;
}

/// Shortens the interval that was tried last, of `length`, to the first of its events. Returns its
/// length; `met`: as for shorten_interval. By the Illinois method: of false position, where an end
/// that stays counts half.
double locate_first_event(const Scene& scene, World& world, Workspace& work, const Movers& movers,
                          double length, bool& met, Stopwatch& watch) {
  double late = length, early = 0.0;
  double late_by = least_clearance(work.events), early_by = least_before(work.events);
  if (!(early_by > 0.0)) early_by = infinity;  // as good as not known
  double tried = length;
  bool corrects = met;
  const auto try_at = [&](double time) {
    tried = time;
    const auto known = static_cast<std::ptrdiff_t>(work.events.size());
    try_again(scene, world, work, movers, {tried, corrects ? shake_rounds : 0}, watch);
    // What a correction throws meets what it never would.
    if (corrects && work.trial.missed == infinity) {
      work.events.erase(work.events.begin() + known, work.events.end());
      try_again(scene, world, work, movers, {tried, 0}, watch);
      corrects = false;
    }
    met = corrects && work.trial.met;
    // Past an event what bore force may be gone, as the end of a wall that a corner has slid over:
    // that nothing is exact there says nothing of what comes before. What contradicts itself does.
    const bool past = least_clearance(work.events) < 0.0;
    corrects = met || (corrects && past && work.trial.settled && !work.trial.contradicts);
  };
  double least_late = late_by;
  bool was_late = false, was_early = false;  // the trial before
  for (int trial = 0; trial < most_trials; ++trial) {
    const double least = least_clearance(work.events);
    if (std::abs(least) <= 0.5 * aim) break;
    if (least < 0.0) {
      if (was_late) early_by *= 0.5;
      late = tried;
      late_by = least_late = least;
    } else {
      if (was_early) late_by *= 0.5;
      early = tried;
      early_by = least;
    }
    was_late = least < 0.0;
    was_early = !was_late;
    double share = 0.5;
    if (early_by < infinity && early_by > 0.0) share = early_by / (early_by - late_by);
    // Not so near to an end that the trial tells nothing new.
    const double next = early + std::clamp(share, 0.02, 0.98) * (late - early);
    const double narrow = is_jump_first(work.events) ? 1e-9 : 1e-15;
    if (!(next > early && next < late) || late - early <= narrow * length) break;
    try_at(next);
  }
  // What jumps is nowhere between: from not yet there it has come to within its reach, and so it
  // has happened then. (A corner that a side has slid over is before one side of it, and then on
  // the other.)
  if (least_clearance(work.events) > 0.5 * aim && least_late < 0.0 && least_late >= -1.0) {
    try_at(late);
  }
  // The linear solution is sound at least.
  if (corrects && !met) try_again(scene, world, work, movers, {tried, 0}, watch);
  return tried;
}

}  // namespace

void go_back(World& world, Workspace& work, std::span<const int> parts) {
  world.diagnostics.fallbacks = work.start.fallbacks;
  for (const int p : parts) put_back(world, work, at(work.parts.list, p));
}

namespace {

/// Notes where the links of a part's cables are that can slide, and that others cannot.
void note_links(const World& world, Workspace& work, const Part& part) {
  Start& start = work.start;
  const bool slides = can_slide(part);
  for (const int c : cables_of(work.parts, part)) {
    at(work.first_link, c) = slides ? static_cast<int>(start.material.size()) : -1;
    if (!slides) continue;
    for (const Link& link : at(world.cables, c).links) {
      start.material.push_back(link.material);
      start.slip.push_back(link.slip_speed);
    }
  }
}

/// Notes where the bodies of a part are.
void note_bodies(const World& world, Workspace& work, const Part& part) {
  Start& start = work.start;
  const auto note = [&](int body) {
    at(start.position, body) = at(world.position, body);
    at(start.velocity, body) = at(world.velocity, body);
    at(start.angle, body) = at(world.angle, body);
    at(start.angular_velocity, body) = at(world.angular_velocity, body);
  };
  for (const int body : bodies_of(work.parts, part)) note(body);
  for (const int shape : carried_of(work.parts, part)) note(shape);
}

}  // namespace

void begin_interval(const World& world, Workspace& work, const Movers& movers, double time) {
  Start& start = work.start;
  const bool all = !work.neighbourhoods.divided;
  start.time = time;
  start.fallbacks = world.diagnostics.fallbacks;
  start.material.clear();
  start.slip.clear();
  work.events.clear();
  start.contact_slip.resize(world.contacts.size());
  start.touching.resize(world.contacts.size());
  start.contact_force.resize(world.contacts.size());
  if (all) {
    work.first_link.assign(world.cables.size(), -1);
    start.position = world.position;
    start.velocity = world.velocity;
    start.angle = world.angle;
    start.angular_velocity = world.angular_velocity;
  }
  for (const int p : movers.parts) {
    Part& part = at(work.parts.list, p);
    if (has_contacts(part)) note_sliding(world, part, work);
    if (!all || can_slide(part)) note_links(world, work, part);
    if (!all) note_bodies(world, work, part);
  }
}

IntervalTrial trial_of(const Workspace& work, std::span<const int> parts) {
  IntervalTrial all;
  for (const int p : parts) add(at(work.trials, p), all);
  return all;
}

bool is_sound(const World& world, const IntervalTrial& trial, double length) {
  return trial.met && sound_length(world, trial, length) == length &&
         !is_outrun(world, trial, length) && length <= trial.longest;
}

double length_to_try(const World& world, const Workspace& work, std::span<const int> parts,
                     double left, bool locates) {
  if (locates) left = std::min(left, longest_interval(world, work.parts, parts));
  double wave = 0.0;
  for (const int p : parts) {
    wave = std::max(wave, wave_on(world, work.parts, at(work.parts.list, p)));
  }
  if (wave == 0.0) return left;
  return left / std::ceil(left / interval_for(world, wave));
}

bool try_whole_interval(const Scene& scene, World& world, Workspace& work, const Movers& movers,
                        double length, Stopwatch& watch) {
  const Attempt attempt{.length = length, .begins = true, .foresees = true};
  try_interval(scene, world, work, movers, attempt, watch);
  return is_sound(world, work.trial, length) && work.events.empty();
}

double shorten_interval(const Scene& scene, World& world, Workspace& work, Movers& movers,
                        double length, bool& met, Stopwatch& watch) {
  const double whole = length;
  for (;;) {
    length = find_sound_interval(scene, world, work, movers, length, watch);
    met = work.trial.met;
    if (work.events.empty()) return length;
    length = locate_first_event(scene, world, work, movers, length, met, watch);
    // What is thrown round as soon as forces act does not come to rest, however short the interval.
    const auto is_thrown = [](const Happening& event) {
      return event.kind >= EventKind::halts && event.clearance < -event.reach;
    };
    if (movers.jumps && std::ranges::any_of(work.events, is_thrown)) {
      movers.jumps = false;
      length = whole;
      work.events.clear();
      try_again(scene, world, work, movers, {length}, watch);
      continue;
    }
    // A node swings the faster the nearer it comes to the rim that takes it in.
    if (!is_outrun(world, work.trial, length)) return length;
    length *= next_share(interval_for(world, work.trial.wave) / length);
    work.events.clear();
    try_again(scene, world, work, movers, {length}, watch);
  }
}

bool cross_interval(const Scene& scene, World& world, Workspace& work, const Movers& movers,
                    double& length, Stopwatch& watch) {
  Attempt attempt{length};
  attempt.begins = true;
  attempt.locates = false;
  try_interval(scene, world, work, movers, attempt, watch);
  attempt.begins = false;
  for (;;) {
    double share = share_for_turns(world, work.trial, length);
    if (is_outrun(world, work.trial, length)) share = interval_for(world, work.trial.wave) / length;
    if (share >= 1.0) break;
    length *= next_share(share);
    attempt.length = length;
    try_again(scene, world, work, movers, attempt, watch);
  }
  if (work.trial.met) return true;
  const double missed = work.trial.missed, whole = length;
  for (int halvings = 0; halvings < most_halvings; ++halvings) {
    length *= 0.5;
    attempt.length = length;
    try_again(scene, world, work, movers, attempt, watch);
    if (work.trial.met) return true;
  }
  attempt.length = length = whole;
  attempt.most_rounds = 0;
  try_again(scene, world, work, movers, attempt, watch);
  // Of two solutions that do not hold the one that misses less.
  if (work.trial.missed > missed && work.trial.missed > most_missed) {
    attempt.most_rounds = shake_rounds;
    try_again(scene, world, work, movers, attempt, watch);
  }
  return false;
}

void note_ways(World& world, const Workspace& work, const Part& part, const IntervalTrial& trial,
               double length, bool met) {
  const Pace before = pace_of(world, work.parts, part);
  Pace after{.lag = 0.5 * length};
  if (met && trial.settled) {
    const double allowed = share_of_error * world.configuration.error;
    after = pace_after(before, {length, trial.foreseen, trial.local_error, allowed});
    const int known = after.intervals - 1;
    const bool curved = known > 0 && before.curved;
    if (curved || (known >= 0 && trial.curves)) {
      after.curved = note_curvatures(at(work.systems, part.system), length, known, curved, world);
    }
  }
  if (part.stretches) note_growth(at(work.systems, part.system), length, world);
  if (after != before) set_pace(world, work.parts, part, after);
}

}  // namespace pinchlab
