// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/advance.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <tuple>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/detect/span_hits.h"
#include "sim/diagnostics.h"
#include "sim/impact.h"
#include "sim/solve/active_set.h"
#include "sim/solve/forces.h"
#include "sim/solve/light_bodies.h"
#include "sim/solve/rows.h"
#include "sim/solve/solution.h"
#include "sim/step.h"

namespace pinchlab {

namespace {

constexpr double exact = 0.1;  // of a part's reach: lengths and gaps at an interval's end

constexpr int most_events = 24;              // that are located in one step
constexpr double share_of_error = 2e-4;      // of Configuration::error that an interval may take
constexpr double shortest = 1e-4;            // of a step, that intervals are divided into for that
constexpr double shortest_corrected = 1e-6;  // of a step
constexpr int shake_rounds = 12;
constexpr int most_trials = 60;   // of an interval's length
constexpr int most_halvings = 5;  // of an interval that does not converge
constexpr int most_repairs = 8;

/// Round-off of a body's place that is nothing to put right (m).
double reach_at(const World& world, int body) {
  return within_reach *
         (at(world.position, body).cwiseAbs().maxCoeff() + at(world.bodies, body).radius);
}

bool is_exact_row(const Row& row) {
  if (row.kind == RowKind::tangent) return false;
  return row.kind != RowKind::pinch_middle || row.slip == Slip::stick;
}

void note_start(const World& world, Start& start) {
  start.fallbacks = world.diagnostics.fallbacks;
  start.position = world.position;
  start.velocity = world.velocity;
  start.angle = world.angle;
  start.angular_velocity = world.angular_velocity;
  start.material.clear();
  start.wrap.clear();
  for (const CableState& cable : world.cables) {
    for (const Link& link : cable.links) {
      start.material.push_back(link.material);
      start.wrap.push_back(link.wrap);
    }
  }
}

/// Everything that moves of a part, `length` seconds after the interval's start.
void place_part(World& world, Workspace& work, const Part& part, double length, bool begins) {
  const Start& start = work.start;
  for (const int number : bodies_of(work.parts, part)) {
    const auto b = index(number);
    world.position[b] = start.position[b] + length * world.velocity[b];
    world.angle[b] = start.angle[b] + length * world.angular_velocity[b];
  }
  for (const int c : cables_of(work.parts, part)) {
    CableState& cable = at(world.cables, c);
    if (part.slides) {
      const auto first = index(at(work.first_link, c));
      for (std::size_t i = 0; i < cable.links.size(); ++i) {
        cable.links[i].material = start.material[first + i] - length * cable.links[i].slip_speed;
      }
    }
    const bool moved = update_cable(world, cable, begins);
    work.spans_moved = work.spans_moved || moved;
  }
}

/// What is left of a row at the present positions (m).
double clearance_of(const Scene& scene, const World& world, const Row& row) {
  if (row.kind == RowKind::segment || row.kind == RowKind::pinch_middle) {
    const Segment& segment = at(at(world.cables, row.index).segments, row.item);
    return segment.rest_length - segment.length;
  }
  const Contact& contact = at(world.contacts, row.index);
  const Vec2& a = at(world.position, contact.a);
  const Vec2 b = contact.b >= 0 ? at(world.position, contact.b)
                                : nearest_point(at(scene.walls, contact.wall), a);
  const double radii = at(world.bodies, contact.a).radius +
                       (contact.b >= 0 ? at(world.bodies, contact.b).radius : 0.0);
  // What has gone through the other is on its far side.
  const Vec2 d = b - a;
  const double distance = d.dot(contact.normal) < 0.0 ? -d.norm() : d.norm();
  return distance - radii - contact.target;
}

/// Adds to the rows' biases what their conditions have missed at the present positions; returns the
/// most (m).
double add_missed(const Scene& scene, const World& world, const CapstanScratch& capstan,
                  const Interval& t, PartSystem& s) {
  double most = 0.0;
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    Row& row = s.rows[r];
    if (row.idle || !is_exact_row(row)) continue;
    if (!row.on && row.kind == RowKind::pinch_middle) continue;
    const bool grouped = !capstan.runs.empty() && capstan.group_of_row[r] >= 0;
    if (grouped && !row.on) continue;
    // By the interval's end as much of what was left at its start must be made up for as by `bias`.
    const bool made_up = row.clearance <= s.reach;
    const double left = row.clearance < -t.made_up ? row.clearance
                        : made_up                  ? (1.0 - t.length / t.repair) * row.clearance
                                                   : 0.0;
    double missed = clearance_of(scene, world, row) - left;
    if (row.compliance > 0.0) {
      if (!row.on || grouped) continue;
      // The stretch over the interval's end is the real one.
      const double straight = row_speed(s, r) - row.bias;
      const double curvature = (missed + left - row.clearance) / t.length - straight;
      missed = (curvature - row.curvature) * t.length;
      row.curvature = curvature;
    }
    // Of a group that is slack as a whole no segment is held to its length.
    const bool bears = row.on && !(grouped && row.impulse == 0.0 &&
                                   at(capstan.groups, capstan.group_of_row[r]).slack >= 0);
    if (!bears) missed = std::min(missed, 0.0);
    row.bias += missed / t.length;
    most = std::max(most, std::abs(missed));
  }
  return most;
}

void forget_flips(PartSystem& s) {
  for (Row& row : s.rows) {
    row.flipped = 0;
    row.returned = false;
  }
}

/// Solves and moves a part; whether its lengths and gaps are exact then.
bool move_part(const Scene& scene, World& world, Workspace& work, Part& part, const Interval& t,
               int most_rounds, bool begins, Stopwatch& watch) {
  PartSystem& s = at(work.systems, part.system);
  SolveScratch& set = work.solve;
  set.step_length = t.repair;
  set.reach = t.reach;
  steady_light_bodies(world, work.parts, part, t.kick, s);
  make_segment_rows(scene, world, work.parts, part, t, s);
  watch.lap(Stage::init_segments);
  make_contact_rows(scene, world, work.parts, part, t, s, set);
  watch.lap(Stage::init_contacts);
  double last = infinity, before_last = infinity;
  Diagnostics& d = world.diagnostics;
  for (int round = 0;; ++round) {
    if (round > 0) forget_flips(s);
    const bool settled = solve_direct(world, work.parts, part, s, set);
    if (!settled) ++d.fallbacks;
    work.settled = work.settled && settled;
    d.active_set_solves = std::max(d.active_set_solves, set.solves);
    store_solution(work.parts, part, s, set.capstan, t.kick, world);
    part.slides = !set.capstan.runs.empty() || part.contacts_begin != part.contacts_end;
    watch.lap(Stage::solve);
    place_part(world, work, part, t.length, begins && round == 0);
    watch.lap(Stage::move_bodies);
    // SHAKE's first correction is the curvature of the way, and the second what the constraints'
    // turning on that way makes of it: of the order of the interval's own error.
    const double missed = add_missed(scene, world, set.capstan, t, s);
    watch.lap(Stage::update_segments);
    if (round == 1) work.local_error = std::max(work.local_error, missed);
    // In so short an interval there is nothing to correct but round-off.
    if (missed <= exact * s.reach || t.length < shortest_corrected * t.repair) return true;
    if (getenv("PL_ROUNDS")) {
      double m = 0;
      size_t rr = 0;
      for (size_t r = 0; r < s.rows.size(); ++r) {
        const Row& row = s.rows[r];
        if (row.idle || !is_exact_row(row) || !row.on) continue;
        double c = std::abs(clearance_of(scene, world, row) - row.clearance);
        if (c > m) {
          m = c;
          rr = r;
        }
      }
      const Row& row = s.rows[rr];
      fprintf(stderr,
              "  round %d t %.9f len %.2e missed %.3e row %zu kind %d idx %d item %d clamped %d "
              "clear0 %.2e now %.2e speed %.2e bias %.2e diag %.1e imp %.2e sym %d solves %d\n",
              round, world.time(), t.length, missed, rr, (int)row.kind, row.index, row.item,
              row.clamped, row.clearance, clearance_of(scene, world, row), row.speed, row.bias,
              row.diagonal, row.impulse, set.symmetric, set.solves);
    }
    // Where states flip it may get worse for a round.
    if (round == most_rounds || !settled || (round > 1 && !(missed < 0.5 * before_last)))
      return false;
    before_last = last;
    last = missed;
  }
}

/// The event of that key, or a new one.
Event& note(std::vector<Event>& events, const Event& key) {
  for (Event& e : events) {
    if (e.kind == key.kind && e.part == key.part && e.row == key.row && e.cable == key.cable &&
        e.item == key.item && e.body == key.body) {
      return e;
    }
  }
  events.push_back(key);
  return events.back();
}

/// Notes what is left of an event; a new one only where it is late by `late` or more (m; below 0: or
/// nearly there).
void measure(std::vector<Event>& events, const Event& key, double clearance, double late) {
  if (events.empty() && clearance >= -late) return;
  bool known = false;
  for (const Event& e : events) {
    known = known || (e.kind == key.kind && e.part == key.part && e.row == key.row &&
                      e.cable == key.cable && e.item == key.item && e.body == key.body);
  }
  if (!known && clearance >= -late) return;
  Event& event = note(events, key);
  event.clearance = clearance;
  event.seen = true;
}

/// Catches of a part: rows that idle and would have to bear force at the present positions.
void find_catches(const Scene& scene, const World& world, Workspace& work, int number) {
  const Part& part = at(work.parts.list, number);
  const PartSystem& s = at(work.systems, part.system);
  const CapstanScratch& capstan = work.solve.capstan;
  const bool slides = !capstan.runs.empty();
  const double late = 0.5 * s.reach;
  Event key{EventKind::catches};
  key.part = number;
  key.reach = s.reach;
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const Row& row = s.rows[r];
    if (!row.idle || row.compliance > 0.0) continue;
    if (row.kind == RowKind::tangent || row.kind == RowKind::pinch_middle) continue;
    if (row.kind == RowKind::segment && slides && capstan.group_of_row[r] >= 0) continue;
    key.row = static_cast<int>(r);
    const double clearance = clearance_of(scene, world, row);
    measure(work.events, key, clearance, row.clearance > s.reach ? -late : late);
  }
  if (!slides) return;
  for (const Group& group : capstan.groups) {
    if (group.slack < 0) continue;
    double before = 0.0, now = 0.0;
    for (int k = group.slack_begin; k < group.slack_end; ++k) {
      const Term& term = at(capstan.slack_terms, k);
      const Row& row = at(s.rows, term.index);
      if (row.compliance > 0.0) continue;
      before += term.coefficient * row.clearance;
      now += term.coefficient * clearance_of(scene, world, row);
    }
    key.row = at(capstan.members, group.slack);
    if (before > s.reach) measure(work.events, key, now, -late);
  }
}

/// Links of a part that have come off.
void find_gone_links(const World& world, Workspace& work, int number) {
  const Part& part = at(work.parts.list, number);
  const PartSystem& s = at(work.systems, part.system);
  Event key{EventKind::link_gone};
  key.part = number;
  key.reach = s.reach;
  for (const int c : cables_of(work.parts, part)) {
    const CableState& cable = at(world.cables, c);
    key.cable = c;
    for (int i = 0; index(i) < cable.links.size(); ++i) {
      const Link& link = at(cable.links, i);
      if (link.orientation == 0 || link.pinch_middle) continue;
      if (needed(cable, index(i))) continue;
      key.item = i;
      measure(work.events, key, link.wrap * link.radius, 0.5 * s.reach);
    }
  }
}

/// Bodies that have met spans; those found before are measured anew.
void find_span_hits(const Scene& scene, World& world, Workspace& work, Stopwatch& watch) {
  for (Event& event : work.events) {
    if (event.kind != EventKind::hit) continue;
    event.clearance = span_clearance(world, at(world.cables, event.cable), index(event.item),
                                     event.body, event.orientation);
    event.seen = true;
  }
  find_pairs(scene, world, work, watch);
  const std::size_t known = work.events.size();
  find_hits(world, work, work.events);
  std::size_t kept = known;
  for (std::size_t i = known; i < work.events.size(); ++i) {
    Event event = work.events[i];
    event.reach =
        std::max(reach_at(world, event.body), within_reach * at(world.cables, event.cable).length);
    event.clearance = span_clearance(world, at(world.cables, event.cable), index(event.item),
                                     event.body, event.orientation);
    event.seen = true;
    bool again = event.clearance >= -0.5 * event.reach;
    for (std::size_t j = 0; j < known; ++j) {
      const Event& old = work.events[j];
      again = again || (old.kind == EventKind::hit && old.cable == event.cable &&
                        old.item == event.item && old.body == event.body);
    }
    if (!again) work.events[kept++] = event;
  }
  work.events.resize(kept);
}

/// Tries an interval from where the last began; whether lengths and gaps are exact at its end. Lists
/// what has happened in it.
bool try_interval(const Scene& scene, World& world, Workspace& work, double length, bool locate,
                  int most_rounds, bool begins, Stopwatch& watch) {
  Interval t;
  t.length = length;
  t.repair = world.step_length;
  t.lag = world.lag;
  t.clamps = true;
  t.kick = world.lag + 0.5 * length;
  t.start = work.start.time;
  apply_forces(scene, world, t, work);
  watch.lap(Stage::apply_forces);
  work.local_error = 0.0;
  work.settled = true;
  for (Event& event : work.events) event.seen = false;
  bool met = true;
  for (int p = 0; index(p) < work.parts.list.size(); ++p) {
    Part& part = at(work.parts.list, p);
    if (part.asleep) continue;
    PartSystem& s = at(work.systems, part.system);
    t.made_up = s.reach;
    t.reach = locate ? s.reach : infinity;
    met = move_part(scene, world, work, part, t, most_rounds, begins, watch) && met;
    if (!locate) continue;
    find_catches(scene, world, work, p);
    find_gone_links(world, work, p);
  }
  if (locate) find_span_hits(scene, world, work, watch);
  for (Event& event : work.events) {
    if (!event.seen) event.clearance = infinity;
  }
  return met;
}

/// Puts everything back to where the interval began.
void go_back(World& world, Workspace& work) {
  const Start& start = work.start;
  world.diagnostics.fallbacks = start.fallbacks;
  world.position = start.position;
  world.velocity = start.velocity;
  world.angle = start.angle;
  world.angular_velocity = start.angular_velocity;
  std::size_t k = 0;
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    CableState& cable = world.cables[c];
    for (Link& link : cable.links) link.material = start.material[k++];
    if (!sleeps(work.parts, c)) update_cable(world, cable, false);
  }
}

/// What closes is met early rather than late, by this share of its reach, so that nothing is ever
/// squeezed or stretched; what changes a cable's course late, so that it has happened.
constexpr double aim = 0.25;

/// Of the events the one of least clearance, over its reach; 0 where it is aimed at.
double least_clearance(const std::vector<Event>& events) {
  double least = infinity;
  for (const Event& event : events) {
    const double wanted = event.kind == EventKind::catches ? aim : -aim;
    least = std::min(least, event.clearance / event.reach - wanted);
  }
  return least;
}

/// The longest interval of at most `length` in which nothing happens but at its end; the world is at
/// its end. Returns its length. `met`: lengths and gaps are exact there.
double find_interval(const Scene& scene, World& world, Workspace& work, double length, bool& met,
                     Stopwatch& watch) {
  work.events.clear();
  met = try_interval(scene, world, work, length, true, shake_rounds, true, watch);
  const double allowed = share_of_error * world.configuration.error;
  while (allowed > 0.0 && met && work.local_error > allowed &&
         length > shortest * world.step_length) {
    go_back(world, work);
    work.events.clear();
    length *= std::clamp(0.8 * std::cbrt(allowed / work.local_error), 0.1, 0.7);
    met = try_interval(scene, world, work, length, true, shake_rounds, false, watch);
  }
  for (int halvings = 0; !met && work.settled && halvings < most_halvings; ++halvings) {
    go_back(world, work);
    work.events.clear();
    length *= 0.5;
    met = try_interval(scene, world, work, length, true, shake_rounds, false, watch);
  }
  if (!met && work.settled) {  // the linear solution is sound at least; what it misses is repaired
    go_back(world, work);
    work.events.clear();
    try_interval(scene, world, work, length, true, 0, false, watch);
  }
  if (work.events.empty()) return length;

  double late = length, early = 0.0;
  double late_by = least_clearance(work.events), early_by = infinity;
  double tried = length;
  for (int trial = 0; trial < most_trials; ++trial) {
    const double least = least_clearance(work.events);
    if (std::abs(least) <= 0.5 * aim) return tried;
    if (least < 0.0) {
      if (trial > 0 && late_by < 0.0 && early_by < infinity) early_by *= 0.5;  // Illinois
      late = tried;
      late_by = least;
    } else {
      early = tried;
      early_by = least;
    }
    double share = 0.5;
    if (early_by < infinity && early_by > 0.0) share = early_by / (early_by - late_by);
    const double next = early + std::clamp(share, 0.02, 0.98) * (late - early);
    if (!(next > early && next < late) || late - early <= 1e-15 * length) break;
    tried = next;
    go_back(world, work);
    met =
        try_interval(scene, world, work, tried, true, met ? shake_rounds : 0, false, watch) && met;
  }
  return tried;
}

/// Velocities at the positions' time, with what bears force now.
void solve_present(const Scene& scene, const World& world, Workspace& work, const Part& part) {
  PartSystem& s = at(work.systems, part.system);
  Interval t;
  t.kick = t.lag = world.lag;
  t.reach = s.reach;
  t.held_only = t.clamps = true;
  work.solve.step_length = world.step_length;
  work.solve.reach = -infinity;
  steady_light_bodies(world, work.parts, part, t.kick, s);
  make_segment_rows(scene, world, work.parts, part, t, s);
  make_contact_rows(scene, world, work.parts, part, t, s, work.solve);
  solve_direct(world, work.parts, part, s, work.solve);
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
  }
  world.lag = 0.0;
}

/// Changes the cables' courses as the events have it that have been met.
void change_courses(World& world, Workspace& work) {
  // From the last link on, so that the indices of others stay.
  std::sort(work.events.begin(), work.events.end(), [](const Event& p, const Event& q) {
    return std::tie(p.cable, p.item) > std::tie(q.cable, q.item);
  });
  int cable_changed = -1, item_changed = -1;
  for (const Event& event : work.events) {
    if (event.cable < 0 || event.clearance > event.reach) continue;
    CableState& cable = at(world.cables, event.cable);
    if (event.cable == cable_changed && item_changed - event.item < 2) continue;
    if (event.kind == EventKind::link_gone) {
      work.released.push_back({event.cable, at(cable.links, event.item).body});
      remove_link(world, cable, event.item);
    } else {
      insert_link(world, cable, index(event.item), event.body, event.orientation);
    }
    cable_changed = event.cable;
    item_changed = event.item;
  }
}

/// Slack that a closing pinch would enclose goes to the spans beside it: to those that are slack
/// already, or to both.
void empty_pinches(World& world) {
  for (CableState& cable : world.cables) {
    for (int i = static_cast<int>(first_segment(cable)); index(i) < cable.segments.size(); ++i) {
      const Segment& segment = at(cable.segments, i);
      if (!segment.pinched || segment.contact < 0 || segment.rest_length <= 0.0) continue;
      const Contact& contact = at(world.contacts, segment.contact);
      if (contact.gap - contact.target > 10.0 * reach_at(world, contact.a)) continue;
      const int from = previous_link(cable, i), after = next_link(cable, i);
      if (after < 0) continue;
      const bool before_slack = at(cable.segments, from).slack;
      const bool after_slack = at(cable.segments, after).slack;
      const double share = before_slack == after_slack ? 0.5 : before_slack ? 1.0 : 0.0;
      const double slack = segment.rest_length;
      at(cable.links, from).material += share * slack;
      at(cable.links, i).material -= (1.0 - share) * slack;
      update_wraps_and_rest_lengths(world, cable);
    }
  }
}

/// The most that a part's constraints are violated by (m).
double violation(const Scene& scene, const World& world, const PartSystem& s) {
  double most = 0.0;
  for (const Row& row : s.rows) {
    if (row.kind == RowKind::tangent || row.kind == RowKind::pinch_middle) continue;
    if (row.compliance == 0.0) most = std::max(most, -clearance_of(scene, world, row));
  }
  return most;
}

/// Moves a part's bodies by `share` of the displacements that were just solved for.
void displace(World& world, Workspace& work, const Part& part, double share) {
  const PartSystem& s = at(work.systems, part.system);
  const std::span<const int> bodies = bodies_of(work.parts, part);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    at(world.position, bodies[i]) += share * s.velocity[i].head<2>();
    at(world.angle, bodies[i]) += share * s.velocity[i].z();
  }
  for (const Run& run : work.solve.capstan.runs) {
    CableState& cable = at(world.cables, run.cable);
    for (int i = run.first_link;; i = next_link(cable, i)) {
      if (!at(cable.links, i).pinch_middle) at(cable.links, i).material -= share * run.speed;
      if (i == run.last_link) break;
    }
  }
  for (const int c : cables_of(work.parts, part)) update_cable(world, at(world.cables, c), false);
}

/// Puts right what is too long or too near in a part by moving its bodies, the heavier the less;
/// their velocities stay. A step of this Newton's method is no longer than a small share of a body,
/// and one that makes nothing better is taken back: where a constraint has hardly any gradient, its
/// violation stays. Returns whether anything has been moved.
bool repair(const Scene& scene, World& world, Workspace& work, Part& part) {
  constexpr double longest = 0.05;  // of a body's radius
  PartSystem& s = at(work.systems, part.system);
  Interval t;
  t.length = t.repair = t.kick = 1.0;
  work.solve.step_length = 1.0;
  work.solve.reach = infinity;
  double share = 0.0, before = infinity;
  bool any = false;
  for (int k = 0; k < most_repairs; ++k) {
    if (k > 0 && violation(scene, world, s) >= before) {
      displace(world, work, part, -share);
      return k > 1;
    }
    std::fill(s.free_velocity.begin(), s.free_velocity.end(), Eigen::Vector3d::Zero());
    make_segment_rows(scene, world, work.parts, part, t, s);
    make_contact_rows(scene, world, work.parts, part, t, s, work.solve);
    before = violation(scene, world, s);
    if (before <= s.reach) break;
    any = true;
    for (Friction& friction : s.frictions) {
      if (at(s.rows, friction.row).kind == RowKind::tangent) friction.dropped = true;
    }
    solve_direct(world, work.parts, part, s, work.solve);
    share = 1.0;
    const std::span<const int> bodies = bodies_of(work.parts, part);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const double radius = at(world.bodies, bodies[i]).radius,
                   way = s.velocity[i].head<2>().norm();
      if (way * share > longest * radius) share = longest * radius / way;
    }
    displace(world, work, part, share);
  }
  return any;
}

}  // namespace

void find_present_velocities(const Scene& scene, const World& world, double time, Workspace& work) {
  Interval instant;
  instant.start = time;
  instant.kick = instant.lag = world.lag;
  apply_forces(scene, world, instant, work);
  for (const Part& part : work.parts.list) {
    if (!part.asleep) solve_present(scene, world, work, part);
  }
}

StepStatus advance(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  Stopwatch watch(times);
  world.diagnostics.active_set_solves = 0;
  double left = world.step_length;
  int events = 0;
  for (int interval = 0; left > 0.0; ++interval) {
    note_start(world, work.start);
    work.start.time = world.time() + (world.step_length - left);
    work.first_link.clear();
    int links = 0;
    for (const CableState& cable : world.cables) {
      work.first_link.push_back(links);
      links += static_cast<int>(cable.links.size());
    }
    work.released.clear();
    work.spans_moved = false;
    work.events.clear();
    const double lag = world.lag;
    const int changes = changes_of_cables(world);
    bool met = true;
    double length = left;
    if (events < most_events) {
      length = find_interval(scene, world, work, left, met, watch);
    } else {
      met = try_interval(scene, world, work, left, false, shake_rounds, true, watch);
      if (!met) {
        go_back(world, work);
        try_interval(scene, world, work, left, false, 0, false, watch);
      }
      ++world.diagnostics.clusters;
    }
    if (!check_finite(scene, world)) return StepStatus::not_finite;
    if (interval == 0 && world.configuration.diagnostics) {
      work.lag_before = lag;
      work.kick_before = lag + 0.5 * length;
      world.diagnostics.energy += kinetic_energy(world, work);
    }
    ++world.diagnostics.intervals;
    world.diagnostics.local_errors += work.local_error;
    if (!met) ++events;
    world.diagnostics.total_solves += world.diagnostics.active_set_solves;
    left = length < left ? left - length : 0.0;
    world.lag = 0.5 * length;
    const double now = work.start.time + length;
    Interval instant;
    instant.start = now;
    const bool happened = !work.events.empty();
    if (getenv("PL_TRACE")) {
      if (happened || !met) {
        fprintf(stderr, "t=%.9f len=%.3e met=%d", world.time() + world.step_length - left, length,
                met);
        for (auto& e : work.events) {
          int idx = -9;
          int kind = -1;
          if (e.part >= 0 && e.row >= 0) {
            auto& r = at(at(work.systems, at(work.parts.list, e.part).system).rows, e.row);
            idx = r.index;
            kind = (int)r.kind;
            if (r.kind == RowKind::normal) {
              idx = world.contacts[(size_t)r.index].a * 100 + world.contacts[(size_t)r.index].b;
            } else
              idx = idx * 100 + r.item;
          }
          fprintf(stderr, " [k%d row%d/%d(%d) c%d i%d b%d %.2e]", (int)e.kind, e.row, idx, kind,
                  e.cable, e.item, e.body, e.clearance / e.reach);
        }
        fprintf(stderr, "\n");
      }
    }
    if (happened) {
      ++world.diagnostics.events;
      ++events;
      catch_up(scene, world, now, work);
      change_courses(world, work);
    }
    for (const Part& part : work.parts.list) {
      if (left == 0.0 && !part.asleep) note_rest(scene, work.parts, part, world);
    }
    detect_after_moving(scene, world, work, times);
    if (happened) empty_pinches(world);
    watch = Stopwatch(times);
    const bool squeezed = std::any_of(
        world.contacts.begin(), world.contacts.end(),
        [&world](const Contact& c) { return c.gap < c.target - 10.0 * reach_at(world, c.a); });
    bool repaired = false;
    const bool changed = changes_of_cables(world) != changes;
    if (!met || happened || changed || squeezed) apply_forces(scene, world, instant, work);
    for (Part& part : work.parts.list) {
      if (part.asleep || (met && !happened && !changed && !squeezed)) continue;
      repaired = repair(scene, world, work, part) || repaired;
    }
    if (repaired && world.lag > 0.0) catch_up(scene, world, now, work);
    if (getenv("PL_TRACE") && happened)
      for (size_t b = 0; b < world.bodies.size(); ++b)
        if (can_move(world.bodies[b]))
          fprintf(stderr, "    before v%zu %.6f %.6f %.6f\n", b, world.velocity[b].x(),
                  world.velocity[b].y(), world.angular_velocity[b]);
    if (happened || repaired) {
      apply_forces(scene, world, instant, work);
      for (const Part& part : work.parts.list) {
        if (!part.asleep) strike(scene, world, work, part);
      }
    }
    if (getenv("PL_TRACE") && happened) {
      for (auto& c : world.cables) {
        fprintf(stderr, "    L:");
        for (size_t i = 0; i < c.links.size(); ++i) {
          auto& l = c.links[i];
          fprintf(stderr, " %d%s%s(%.2e)", l.body,
                  l.orientation > 0   ? "+"
                  : l.orientation < 0 ? "-"
                                      : "",
                  l.pinch_middle ? "m" : "", l.wrap);
          if (i >= first_segment(c))
            fprintf(stderr, " [T%.2f %s%s C%.1e L%.2e]", c.segments[i].tension,
                    c.segments[i].slack ? "s" : "", c.segments[i].pinched ? "p" : "",
                    c.segments[i].length - c.segments[i].rest_length, c.segments[i].length);
        }
        fprintf(stderr, "\n");
      }
      for (auto& c : world.contacts)
        fprintf(stderr, "    contact %d-%d gap-target %.2e touching %d rebounds %d linked %d\n",
                c.a, c.b, c.gap - c.target, c.touching, c.rebounds, c.pinch_linked);
      for (size_t b = 0; b < world.bodies.size(); ++b)
        if (can_move(world.bodies[b]))
          fprintf(stderr, "    v%zu %.6f %.6f %.6f\n", b, world.velocity[b].x(),
                  world.velocity[b].y(), world.angular_velocity[b]);
    }
    watch.lap(Stage::solve);
  }
  return StepStatus::ok;
}

}  // namespace pinchlab
