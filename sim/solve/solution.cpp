// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/solution.h"

#include <cmath>
#include <span>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/parts.h"
#include "sim/solve/capstan.h"
#include "sim/solve/friction.h"
#include "sim/solve/rubbing.h"

namespace pinchlab {

namespace {

/// The state of the cable on the middle body of a pinch.
void store_middle(const PartSystem& s, const CapstanScratch& capstan, const Row& row, Link& link) {
  const bool sticks = row.on && row.slip == Slip::stick;
  link.slip = row.slip;
  // A bias is what it missed while it stuck: nothing makes up for that where it slides.
  link.slip_speed = sticks ? 0.0 : row.speed - row.bias + run_speed(s, capstan, row);
}

/// What idles within reach of bearing force, as an elastic segment does at an instant, stays what
/// it was.
void store_segment_row(const PartSystem& s, const CapstanScratch& capstan, const Row& row,
                       double kick, World& world) {
  CableState& cable = at(world.cables, row.index);
  Segment& segment = at(cable.segments, row.item);
  if (kick > 0.0) segment.tension = row.impulse / kick;
  if (row.kind == RowKind::pinch_middle) {
    store_middle(s, capstan, row, at(cable.links, row.item));
  } else if (!row.idle || row.clearance > s.reach) {
    segment.slack = !row.on;
  }
}

void store_contact_row(const Row& row, double kick, World& world) {
  Contact& contact = at(world.contacts, row.index);
  if (row.kind == RowKind::normal) {
    contact.touching = row.on;
    if (kick > 0.0) contact.normal_force = row.impulse / kick;
  } else {
    const int way = way_of_row(contact);
    // No blow stops what it does not rub on.
    if (kick > 0.0 || row.impulse != 0.0) contact.slip = along(way, row.slip);
    if (kick > 0.0) contact.tangent_force = way * row.impulse / kick;
  }
}

/// m/s, by which a solve's impulses have changed what rows bear them for, at most and in all.
double change_by_impulses(const PartSystem& s) {
  double change = 0.0;
  for (const Row& row : s.rows) change += row.diagonal * std::abs(row.impulse);
  return change;
}

/// A run's state on all of its links; a run that bears nothing and does not move sticks. A blow
/// that changes speeds by `struck` (m/s; infinity: no blow) tells nothing of how cable slides that
/// it does not pull, or that would slide otherwise by more: where it meets next to nothing, that is
/// for the forces to tell, which hold the cable as the blow does not.
void store_run(const PartSystem& s, const Run& run, double struck, World& world) {
  const bool bears =
      at(s.rows, run.row_in).impulse != 0.0 || at(s.rows, run.row_out).impulse != 0.0;
  const Slip slip = !bears && run.speed == 0.0 ? Slip::stick : run.slip;
  CableState& cable = at(world.cables, run.cable);
  const double before = at(cable.links, run.first_link).slip_speed;
  const bool tells = struck == infinity || (bears && std::abs(run.speed - before) <= struck);
  for (int i = run.first_link;; i = next_link(cable, i)) {
    Link& link = at(cable.links, i);
    if (!link.pinch_middle || run.first_link == run.last_link) {
      link.slip = slip;
      if (tells) link.slip_speed = run.speed;
    }
    if (i == run.last_link) break;
  }
}

}  // namespace

void store_solution(const Parts& parts, const Part& part, PartSystem& s,
                    const CapstanScratch& capstan, const TimeSpan& interval, World& world) {
  const double kick = interval.tells_forces() ? interval.kick : 0.0;
  const std::span<const int> bodies = bodies_of(parts, part);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    at(world.velocity, bodies[i]) = s.velocity[i].head<2>();
    at(world.angular_velocity, bodies[i]) = s.velocity[i].z();
  }
  carry(world, carried_of(parts, part));
  share_among_repeated(s);
  const std::span<const Row> rows(s.rows), segments = rows.first(index(s.first_sleeve_row));
  for (const Row& row : segments) store_segment_row(s, capstan, row, kick, world);
  for (const Row& row : rows.subspan(index(s.first_contact_row))) {
    store_contact_row(row, kick, world);
  }
  const bool is_blow = interval.length == 0.0 && !capstan.runs.empty();
  const double struck = is_blow ? change_by_impulses(s) : infinity;
  for (const Run& run : capstan.runs) store_run(s, run, struck, world);
  if (!s.sleeves.empty()) store_rubbing(s, world);
}

void store_tensions(PartSystem& s, double kick, World& world) {
  share_among_repeated(s);
  for (const Row& row : std::span(s.rows).first(index(s.first_sleeve_row))) {
    at(at(world.cables, row.index).segments, row.item).tension = row.impulse / kick;
  }
}

}  // namespace pinchlab
