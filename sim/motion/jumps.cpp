// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/jumps.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/motion/events.h"
#include "sim/solve/contact_bodies.h"
#include "sim/solve/foresight.h"
#include "sim/solve/friction.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// What changes evenly in the kick of an interval.
struct Ramp {
  double before = 0.0, after = 0.0;  // of the kick, in its units

  double at(double share) const { return before + share * (after - before); }
};

/// The interval that has been tried, in shares of its kick.
struct Moments {
  double start = 0.0, end = 1.0;  // of the interval
  double length = 0.0;            // s

  Moments(double lag, double of_length)
      : start(lag / (lag + 0.5 * of_length)),
        end(start + of_length / (lag + 0.5 * of_length)),
        length(of_length) {}
};

/// The velocity of what carries a body, or of the world, at some share of the kick.
Eigen::Vector3d velocity_at(const World& world, const Start& start, int body, double share) {
  if (body < 0) return Eigen::Vector3d::Zero();
  const int mover = mover_of(world, body);
  const Vec2& before = at(start.velocity, mover);
  const Vec2 v = before + share * (at(world.velocity, mover) - before);
  const Ramp turning{at(start.angular_velocity, mover), at(world.angular_velocity, mover)};
  return {v.x(), v.y(), turning.at(share)};
}

double sliding_at(const World& world, const Start& start, const Contact& contact,
                  const RowBodies& bodies, double share) {
  return dot(bodies.ja, velocity_at(world, start, contact.a, share)) +
         dot(bodies.jb, velocity_at(world, start, contact.b, share));
}

/// Whether a contact's friction is one that may turn round at an event of its own. A node's of a
/// cable that hangs is not: hardly anything depends on when, and a cable that lies down has one
/// after another of them.
bool may_halt(const World& world, const Contact& contact) {
  if (!contact.touching || contact.normal_force == 0.0) return false;
  if (contact.touch == Touch::piece) return false;
  if (at(world.bodies, contact.a).node) return false;
  return contact.b < 0 || !at(world.bodies, contact.b).node;
}

/// Whether it is between two discs, on which nothing turns.
bool is_of_discs(const Contact& contact) {
  return contact.touch == Touch::circles && contact.b >= 0;
}

/// Whether a contact is of a disc and a wall whose ends that has been nowhere near in an interval
/// of `length` (s), as most are.
bool stays_on_wall(const World& world, const Contact& contact, double length) {
  if (contact.touch != Touch::circles || contact.b >= 0) return false;
  const Obstacle& wall = at(world.obstacles, contact.wall);
  const Vec2 way = wall.b - wall.a;
  const double along = way.dot(at(world.position, contact.a) - wall.a);
  const double moved = length * std::abs(way.dot(at(world.velocity, mover_of(world, contact.a))));
  return along > moved && way.squaredNorm() - along > moved;
}

/// A part's interval that has just been tried.
struct Tried {
  const World& world;
  Workspace& work;
  const PartSystem& s;
  Moments moments;
  Happening key{EventKind::halts};

  /// Of what slides that way by `then` (m/s) as the interval begins, and would by `now` at its end.
  void note(double way, double then, double now) {
    constexpr double at_once = 1e-4;  // of the interval: what rests so soon does at its start
    constexpr double crawl = 100.0;   // reaches in a step: far above what solves leave of sticking
    constexpr double at_rest = 1e-8;  // of the speed
    const double h = world.step_length, before = way > 0.0 ? then : -then;  // s, m/s
    const bool slides = h * before > crawl * s.reach && before > at_once * std::abs(then - now);
    key.before = h * before;
    key.reach = at_rest * key.before;
    measure(work, key, way > 0.0 ? h * now : -h * now, slides ? 0.5 * key.reach : infinity);
  }

  /// How fast a link's cable slides (m/s).
  Ramp sliding_of(int cable, int link) const {
    const int first = at(work.first_link, cable);
    if (first < 0) return {};
    return {at(work.start.slip, first + link), at(at(world.cables, cable).links, link).slip_speed};
  }

  /// The same of the cable that a contact presses.
  Ramp sliding_under(const Contact& contact) const {
    if (contact.slipping_cable < 0) return {};
    const std::vector<Link>& links = at(world.cables, contact.slipping_cable).links;
    for (int i = 0; index(i) < links.size(); ++i) {
      if (presses(contact, contact.slipping_cable, at(links, i))) {
        return sliding_of(contact.slipping_cable, i);
      }
    }
    return {};
  }

  void find_contacts_that_halt();
  void find_links_that_halt(int cable);
  void find_motors_that_catch_up(const Scene& scene, std::span<const int> bodies);
};

void Tried::find_contacts_that_halt() {
  const Start& start = work.start;
  for (std::size_t r = index(s.first_contact_row); r < s.rows.size(); ++r) {
    if (s.rows[r].kind != RowKind::tangent) continue;
    key.row = s.rows[r].index;
    const int slid = static_cast<int>(at(start.contact_slip, key.row));
    const Contact& contact = at(world.contacts, key.row);
    if (slid == 0 || !may_halt(world, contact)) continue;
    const int way = way_of_row(contact);
    const Ramp cable = sliding_under(contact);
    const auto sliding = [&](const RowBodies& bodies, double share) {
      return sliding_at(world, start, contact, bodies, share) + cable.at(share);
    };
    const double then = way * sliding(s.bodies[r], moments.start);
    // A wall stands where it stood, and so does what is seen of a disc on it.
    if (stays_on_wall(world, contact, moments.length)) {
      note(slid, then, sliding(s.bodies[r], moments.end));
      continue;
    }
    Contact at_end = contact;
    measure(world, at_end);
    RowBodies bodies;
    set_tangent_bodies(world, at_end, {}, bodies);
    note(slid, then,
         sliding_at(world, start, contact, bodies, moments.end) + way * cable.at(moments.end));
  }
  key.row = -1;
}

void Tried::find_links_that_halt(int number) {
  const CableState& cable = at(world.cables, number);
  // What stretches loses its tensions' difference as it comes to rest, little by little.
  if (at(work.first_link, number) < 0 || cable.elastic) return;
  key.cable = number;
  for (key.item = 0; index(key.item) < cable.links.size(); ++key.item) {
    const Ramp sliding = sliding_of(number, key.item);
    if (sliding.before == 0.0) continue;
    if (at(world.bodies, at(cable.links, key.item).body).cable_friction == 0.0) continue;
    // Without tension cable slides as it is shared out, and nothing brakes it.
    const int after = next_link(cable, key.item);
    const bool bears = at(cable.segments, key.item).tension != 0.0 ||
                       (after >= 0 && at(cable.segments, after).tension != 0.0);
    if (!bears) continue;
    note(sliding.before, sliding.at(moments.start), sliding.at(moments.end));
  }
  key.cable = key.item = -1;
}

void Tried::find_motors_that_catch_up(const Scene& scene, std::span<const int> bodies) {
  // A blow throws a motor with a limit back as if there were none. One that makes up for that in
  // next to no time does so at the interval's start.
  constexpr double at_once = 1e-3;  // of a step
  const double begun = work.start.time;
  for (const Motor& motor : s.motors) {
    if (motor.most == infinity) continue;
    key.body = at(bodies, motor.place);
    const Body& body = at(scene.bodies, key.body);
    const auto asked = [&](double time) {
      return body.motor.empty() ? *body.driven_angular_velocity : drive_at(body.motor, time);
    };
    const Ramp turning{motor.before, at(world.angular_velocity, key.body)};
    const double then = turning.at(moments.start) - asked(begun);
    const double least_time = motor.inertia * std::abs(then) / body.torque_limit;  // s
    if (least_time <= at_once * world.step_length) continue;
    const double now = turning.at(moments.end) - asked(begun + moments.length);
    note(then, body.radius * then, body.radius * now);
  }
  key.body = -1;
}

/// Of speeds that motors hold, by the time at which the interval has `ended` (s). Those of torques
/// only turn what does not jump.
void find_corners_of_tables(const Scene& scene, const World& world, Workspace& work, int number,
                            double ended) {
  constexpr double rounding = 1e-9;  // of a step
  Happening key{EventKind::turns};
  key.part = number;
  key.reach = rounding * world.step_length;
  for (const int b : bodies_of(work.parts, at(work.parts.list, number))) {
    if (!at(scene.bodies, b).driven_angular_velocity) continue;
    const std::vector<MotorPoint>& motor = at(scene.bodies, b).motor;
    const auto next =
        std::ranges::upper_bound(motor, work.start.time + key.reach, {}, &MotorPoint::time);
    if (next == motor.end()) continue;
    key.body = b;
    key.before = next->time - work.start.time;
    measure(work, key, next->time - ended, -key.reach);
  }
}

/// What comes to rest: contacts, motors, cable.
void find_halts(const Scene& scene, const World& world, Workspace& work, int number,
                double length) {
  const Part& part = at(work.parts.list, number);
  const double lag = pace_of(world, work.parts, part).lag;
  Tried tried{world, work, at(work.systems, part.system), Moments(lag, length)};
  tried.key.part = number;
  tried.find_contacts_that_halt();
  if (!tried.s.motors.empty()) {
    tried.find_motors_that_catch_up(scene, bodies_of(work.parts, part));
  }
  if (!may_come_to_rest(part)) return;
  for (const int c : cables_of(work.parts, part)) tried.find_links_that_halt(c);
}

/// Where what presses cable that cannot slip lets go of it: of a normal row of the whole interval,
/// which was as long as the two before it, and a row that holds as long as it bears force. Its
/// force now is that of the interval's start, and falls as it has done since the one before began.
void note_letting_go(const World& world, Workspace& work, int number, int normal, const Row& held,
                     double length) {
  constexpr double rounding = 1e-6;  // of a step: far below what the fall is known to
  constexpr double shows = 10.0;     // reaches in a step, by what ends then
  const PartSystem& s = at(work.systems, at(work.parts.list, number).system);
  const Row& row = at(s.rows, normal);
  const double before = at(work.start.contact_force, row.index);  // N
  const double now = at(world.contacts, row.index).normal_force;
  const double takes = held.diagonal * std::abs(held.impulse);  // m/s
  if (!row.on || !(before > now) || takes * length <= shows * s.reach) return;
  Happening key{EventKind::lets_go};
  key.part = number;
  key.row = row.index;
  key.before = length * now / (before - now);
  key.reach = rounding * world.step_length;
  measure(work, key, key.before - length, -key.reach);
}

/// Whether a friction row holds for as long as a contact bears force, by whatever it takes.
bool holds(const Friction& friction) {
  return friction.normal >= 0 && friction.bound == infinity;
}

/// What lets go, at times that the whole interval has told.
void find_contacts_that_let_go(const World& world, Workspace& work, int number, double length) {
  for (Happening& event : work.events) {
    if (event.kind != EventKind::lets_go || event.part != number) continue;
    event.clearance = event.before - length;
    event.seen = true;
  }
  const Part& part = at(work.parts.list, number);
  const Pace& pace = pace_of(world, work.parts, part);
  if (pace.intervals == 0 || !is_even(pace.lag, length)) return;
  const PartSystem& s = at(work.systems, part.system);
  for (const Friction& friction : s.frictions) {
    const Row& row = at(s.rows, friction.row);
    if (!holds(friction) || row.impulse == 0.0) continue;
    note_letting_go(world, work, number, friction.normal, row, length);
  }
  for (const int r : s.pressed) {
    const Row& row = at(s.rows, r);
    if (!row.clamped || row.presser < 0 || row.impulse >= 0.0) continue;
    note_letting_go(world, work, number, row.presser, row, length);
  }
}

/// Discs and corners that come to corners.
void find_turns(const World& world, Workspace& work, int number, double length) {
  const Part& part = at(work.parts.list, number);
  const double reach = at(work.systems, part.system).reach;
  for (const int c : contacts_of(work.parts, part)) {
    const Contact& contact = at(world.contacts, c);
    if (!at(work.start.touching, c) || is_of_discs(contact) ||
        stays_on_wall(world, contact, length))
      continue;
    const double before = on_straight(world, contact, work.start.position, work.start.angle);
    if (!(std::abs(before) > reach && std::abs(before) < infinity)) continue;
    const double now = on_straight(world, contact, world.position, world.angle);
    Happening key{EventKind::turns};
    key.part = number;
    key.row = c;
    key.reach = reach;
    key.before = std::abs(before);
    measure(work, key, before > 0.0 ? now : -now, 0.5 * reach);
  }
}

}  // namespace

void note_sliding(const World& world, Part& part, Workspace& work) {
  part.slid = part.may_turn = false;
  if (!part.can_move) return;
  const std::span<Slip> slips = work.start.contact_slip;
  const std::span<char> touching = work.start.touching;
  for (const int c : contacts_of(work.parts, part)) {
    const Contact& contact = at(world.contacts, c);
    at(slips, c) = contact.slip;
    at(touching, c) = contact.touching ? 1 : 0;
    at(work.start.contact_force, c) = contact.normal_force;
    part.slid = part.slid || contact.slip != Slip::stick;
    part.may_turn = part.may_turn || !is_of_discs(contact);
  }
}

void find_jumps(const Scene& scene, const World& world, Workspace& work, int number,
                double length) {
  const Part& part = at(work.parts.list, number);
  const PartSystem& s = at(work.systems, part.system);
  if (may_come_to_rest(part) || !s.motors.empty() || part.slid) {
    find_halts(scene, world, work, number, length);
  }
  if (s.has_tables) find_corners_of_tables(scene, world, work, number, work.start.time + length);
  if (part.may_turn) find_turns(world, work, number, length);
  if (holds_by_force(part, s)) find_contacts_that_let_go(world, work, number, length);
}

void end_jump(World& world, const Happening& event) {
  if (event.body >= 0) return;                   // a motor's state follows from its speed
  if (event.kind == EventKind::lets_go) return;  // and whether a contact bears force from its own
  if (event.kind == EventKind::turns) {
    Contact& contact = at(world.contacts, event.row);
    if (ends_beyond(contact)) contact.touching = false;
    return;
  }
  if (event.row >= 0) {
    at(world.contacts, event.row).slip = Slip::stick;
    return;
  }
  CableState& cable = at(world.cables, event.cable);
  if (index(event.item) >= cable.links.size()) return;
  at(cable.links, event.item).slip = Slip::stick;
}

}  // namespace pinchlab
