// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/rows.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held_spans.h"
#include "sim/compound.h"
#include "sim/parts.h"
#include "sim/solve/contact_bodies.h"
#include "sim/solve/elastic.h"
#include "sim/solve/friction.h"
#include "sim/solve/rubbing.h"
#include "sim/solve/solve_scratch.h"
#include "sim/tangent.h"
#include "sim/touch.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// What a unit impulse on the row does to its bodies, and to its own speed.
void weigh(PartSystem& s, int r) {
  const RowBodies& bodies = at(s.bodies, r);
  RowResponse& response = at(s.responses, r);
  response.ra = at(s.mobility, bodies.a) * bodies.ja;
  response.rb = at(s.mobility, bodies.b) * bodies.jb;
  at(s.rows, r).diagonal = bodies.ja.dot(response.ra) + bodies.jb.dot(response.rb);
  if (s.thirds.empty() || !at(s.rows, r).has_third) return;
  ThirdBody& third = at(s.thirds, at(s.rows, r).item);
  third.response = at(s.mobility, third.place) * third.j;
  at(s.rows, r).diagonal += third.j.dot(third.response);
}

bool has_fixed_lever(const World& world, const CableState& cable, int number) {
  const Link& link = at(cable.links, number);
  if (link.body < 0 || (is_central(link) && mover_of(world, link.body) == link.body)) return true;
  if (link.moored) return false;
  // What slips turns about the link's own circle, and of what is fixed nothing else moves.
  const int mover = mover_of(world, link.body);
  const bool fixed = link.corner >= 0 && at(world.bodies, mover).kind == BodyKind::fixed;
  return fixed || is_on_sleeve(world, cable, number);
}

/// Lever of a force along e on the link's circle: torque on the body = lever * force, since
/// cross(c - p left(e), e) = cross(c, e) + p with the circle's centre at c from the body's.
double lever(const World& world, const CableState& cable, int number, const Vec2& e) {
  const Link& link = at(cable.links, number);
  const double p = link.signed_radius();
  if (has_fixed_lever(world, cable, number)) return p;
  return p + cross(link_centre(world, link) - pivot_of_link(world, cable, number), e);
}

/// dC/dt = e.(v_B - v_A) + p_B om_B - p_A om_A with C = L - l; the row's J is its negative, so that
/// tension (p >= 0) shortens the segment.
///
/// Where the bodies have sunk into a pinched cable, their distance D is less than
///     |Delta| = R_A + R_B.
/// There L is 0 and e, across the centre line, turns at e.(v_B - v_A) / D: dC/dt has
///     |Delta| / D times e.(v_B - v_A).
/// So J says how rest lengths change, and its forces have no moment: neither energy nor angular
/// momentum comes from a pinch.
void set_segment_bodies(const World& world, const CableState& cable, int from, int to, bool sunk,
                        RowBodies& row) {
  const Segment& segment = at(cable.segments, to);
  Vec2 e = segment.direction;
  if (sunk) {
    const double distance = (segment.head_centre - segment.tail_centre).norm();
    const double p_a = at(cable.links, from).signed_radius();
    const double delta = std::abs(at(cable.links, to).signed_radius() - p_a);
    if (distance > 0.0) e *= delta / distance;
  }
  row.ja = {e.x(), e.y(), lever(world, cable, from, e)};
  row.jb = {-e.x(), -e.y(), -lever(world, cable, to, e)};
}

/// What the row has left before it bears force, and what its speed must therefore be.
inline void set_clearance(double clearance, const TimeSpan& interval, Row& row) {
  const bool far = clearance > interval.reach;
  row.clearance = clearance;
  row.idle = far || (interval.held_only && !row.on);
  row.on = row.on && !row.idle;
  // What is left within reach is round-off, which a short interval must not make a speed of.
  const bool free = far || interval.reach == infinity;
  const double time = clearance > 0.0 && free ? interval.length : interval.repair;
  row.bias = interval.length > 0.0 && clearance >= -interval.made_up ? clearance / time : 0.0;
}

/// What is left before a segment bears tension (m). Where plain cable joints have crossed bodies,
/// rolling has moved material that no row has held; what is left of a segment is then at least
/// nothing.
double clearance_left(const Segment& segment, bool plain) {
  const double rest = plain ? std::max(segment.rest_length, 0.0) : segment.rest_length;
  return rest - segment.length;
}

/// A middle body's row is never idle: what material has gone astray in its pinch, either way, is
/// made up for in time, or stays.
inline void hold_middle(double clearance, const TimeSpan& interval, Row& row) {
  row.clearance = clearance;
  row.idle = false;
  const bool made_up = interval.length > 0.0 && std::abs(clearance) <= interval.made_up;
  row.bias = made_up ? clearance / interval.repair : 0.0;
}

/// All of a segment's row but its bodies and its friction, as it is before a solve.
inline void set_segment_values(const Segment& segment, bool plain, const TimeSpan& interval,
                               Row& row) {
  row.on = !segment.slack;
  row.slip = Slip::stick;
  row.clamped = row.returned = row.stretches = false;
  row.flipped = 0;
  row.presser = -1;
  row.curved = row.compliance = 0.0;
  const double clearance = clearance_left(segment, plain);
  if (row.kind == RowKind::pinch_middle) {
    hold_middle(clearance, interval, row);
  } else {
    set_clearance(clearance, interval, row);
  }
}

/// A rod's row is never slack and has nothing to spare.
void hold_both_ways(const TimeSpan& interval, Row& row) {
  row.clamped = row.on = true;
  row.idle = false;
  const double time = interval.repair;
  row.bias = interval.length > 0.0 ? row.clearance / time : 0.0;
}

/// Plain cable joints know no pinch: where the tangent has vanished, the segment joins the
/// attachment points along the centre line, backwards (thesis 4.2.1, Figure 4.3). It then pushes
/// the bodies apart, but leaves their rolling alone: the origin of the method's jitter.
void turn_to_centre_line(const World& world, const Link& from, const Link& to,
                         const Segment& segment, const TimeSpan& interval, RowBodies& bodies,
                         Row& row) {
  const Vec2 d = link_centre(world, to) - link_centre(world, from);
  const double distance = d.norm();
  if (!(distance > 0.0)) return;
  const Vec2 u = d / distance;
  bodies.ja = {-u.x(), -u.y(), 0.0};
  bodies.jb = {u.x(), u.y(), 0.0};
  const double overlap = from.radius + to.radius - distance;
  set_clearance(std::max(segment.rest_length, 0.0) - overlap, interval, row);
}

void set_normal_row(const Scene& scene, const World& world, const Contact& contact,
                    const TimeSpan& interval, RowBodies& bodies, Row& row) {
  const Vec2& n = contact.normal;
  row.kind = RowKind::normal;
  row.on = contact.touching;
  bodies.ja = {-n.x(), -n.y(), 0.0};
  bodies.jb = {n.x(), n.y(), 0.0};
  if (contact.touch == Touch::piece) {
    // By set_bodies_at_piece.
  } else if (contact.touch != Touch::circles) {
    set_levers(world, contact, bodies);
  } else {
    add_seats(world, contact, bodies);
  }
  const double clearance = contact.gap - target_of(world, contact);
  set_clearance(clearance, interval, row);
  // Where events are not located contacts bar half a plane: of a point, what only passes it too.
  const bool is_passing =
      interval.reach == infinity && is_end_of_cable(world, contact) && clearance > interval.made_up;
  if (contact.away != 0) row.clearance = infinity;
  if (is_passing || contact.away != 0 || (contact.rebounds && interval.reach < infinity)) {
    row.idle = true;
    row.on = false;
    if (contact.away != 0) row.bias = 0.0;
  }
  // Rebounds are impacts (impact.h), and positions that are repaired do not rebound.
  if (locates_events(world.configuration) || interval.length == 0.0) return;
  const double restitution = restitution_of(world, contact);
  if (restitution == 0.0) return;
  const double speed =
      speed_of(world, contact.a, bodies.ja) + speed_of(world, contact.b, bodies.jb);
  // Slower than what gravity gives in four steps, a body rests rather than bounces.
  const double slowest = 4.0 * scene.gravity.norm() * world.step_length;
  if (speed < -slowest && clearance + world.step_length * speed < 0.0) {
    row.bias = restitution * speed;
    row.rebounds = true;
  }
}

/// A new last row between two places.
int append_row(PartSystem& s, int a, int b) {
  s.rows.emplace_back();
  RowBodies& bodies = s.bodies.emplace_back();
  RowResponse& response = s.responses.emplace_back();
  bodies.a = response.a = a;
  bodies.b = response.b = b;
  s.changed.push_back(true);
  return static_cast<int>(s.rows.size()) - 1;
}

/// As the row of a middle body is: what pulls one along the cable pulls the other against it.
void turn_about(RowBodies& row) {
  row.ja = -row.ja;
  row.jb = -row.jb;
}

void add_friction(PartSystem& s, const Friction& friction) {
  at(s.rows, friction.row).friction = static_cast<int>(s.frictions.size());
  s.frictions.push_back(friction);
}

/// The friction of a contact of coefficient mu, whose normal row that is.
void append_tangent_row(const World& world, const Parts& parts, int normal, double mu,
                        const TimeSpan& interval, PartSystem& s) {
  const Contact& contact = at(world.contacts, at(s.rows, normal).index);
  const bool in_pinch = contact.slipping_cable >= 0;
  int a = at(s.bodies, normal).a, b = at(s.bodies, normal).b;
  int& pressed = contact.slips_on == contact.a ? a : b;
  if (in_pinch) pressed = place_that_is_pressed(world, s, contact, pressed);
  const int tangent = append_row(s, a, b);
  Row& row = s.rows.back();
  row.kind = RowKind::tangent;
  row.index = at(s.rows, normal).index;
  if (contact.touch == Touch::piece) {
    set_bodies_at_piece(world, parts, contact, true, s, tangent);
  } else {
    set_tangent_bodies(world, contact, interval, s.bodies.back());
    if (in_pinch) roll_on_sleeve(s, contact, pressed, s.bodies.back());
  }
  const int way = way_of_row(contact);
  row.slip = along(way, contact.slip);
  if (way < 0) turn_about(s.bodies.back());
  if (locates_events(world.configuration) && interval.length > 0.0 && !interval.straight) {
    row.bias = row.curved = way * change_of_sliding(world, contact, interval.length);
  }
  weigh(s, tangent);
  Friction friction = contact_friction(tangent, normal, mu);
  if (in_pinch) {
    const CableState& cable = at(world.cables, contact.slipping_cable);
    friction.wrapped = friction_in_pinch(world, cable, contact.slips_on);
  }
  add_friction(s, friction);
}

/// The rows of a contact that can give way.
void append_contact_rows(const Scene& scene, const World& world, const Parts& parts, int number,
                         const TimeSpan& interval, PartSystem& s, SolveScratch& scratch) {
  const Contact& contact = at(world.contacts, number);
  const int normal = append_row(s, place_of(parts, s, contact.a), place_of(parts, s, contact.b));
  at(scratch.normal_row_of_contact, number) = normal;
  s.rows.back().index = number;
  s.loose.push_back(normal);
  set_normal_row(scene, world, contact, interval, s.bodies.back(), s.rows.back());
  if (contact.touch == Touch::piece) {
    set_bodies_at_piece(world, parts, contact, false, s, normal);
  } else if (contact.layers_cable >= 0 && contact.target > 0.0) {
    add_growth_of_layers(world, parts, contact, s, normal);
  }
  weigh(s, normal);
  const double mu = coefficient_of(world, contact);
  if (mu == 0.0 || only_turns_one(world, contact)) return;
  append_tangent_row(world, parts, normal, mu, interval, s);
}

/// The rows of middle bodies as they are before a solve, by what bounds them.
void begin_middles(PartSystem& s) {
  for (Friction& friction : s.frictions) {
    Row& row = at(s.rows, friction.row);
    if (row.kind != RowKind::pinch_middle) continue;
    friction.dropped = friction.frozen = false;
    friction.slid = Slip::stick;
    if (friction.normal < 0 && friction.coefficient == infinity) {
      row.on = true;
      row.slip = Slip::stick;
    }
    if (friction.repeats >= 0) row.on = false;
  }
}

/// Notes what clamps the cable of a transitional pinch between two bodies both of which hold it by
/// friction: the row of the force that presses; or, between axles that do not give way and without
/// slip, whatever it takes. What has come in slack, by more than `reach` (m), is not pulled out.
void clamp_in_pinch(const World& world, const SolveScratch& scratch, double reach, Row& row) {
  const CableState& cable = at(world.cables, row.index);
  if (row.idle || row.compliance > 0.0 || row.clearance > reach) return;
  const int tail = at(cable.links, previous_link(cable, row.item)).body;
  const int head = at(cable.links, row.item).body;
  const double least =
      std::min(friction_in_pinch(world, cable, tail), friction_in_pinch(world, cable, head));
  if (least == 0.0) return;
  row.presser = at(scratch.normal_row_of_contact, at(cable.segments, row.item).contact);
  if (row.presser < 0 && least == infinity) row.clamped = row.on = true;
}

/// Lists the rows of a part's segments: between which places, and of what kind.
void list_segment_rows(const World& world, const Parts& parts, const Part& part, PartSystem& s) {
  const bool three = world.configuration.pinch_rows == PinchRows::three;
  s.rows.clear();
  s.bodies.clear();
  s.responses.clear();
  s.changed.clear();
  s.assembled.clear();
  s.row_of_segment.clear();
  s.segment_begin.clear();
  s.middles.clear();
  for (const int c : cables_of(parts, part)) {
    const CableState& cable = at(world.cables, c);
    const std::size_t begin = s.row_of_segment.size();
    s.segment_begin.push_back(static_cast<int>(begin));
    s.row_of_segment.resize(begin + cable.segments.size(), -1);
    for (int i = static_cast<int>(first_segment(cable)); index(i) < cable.segments.size(); ++i) {
      const int before = previous_link(cable, i);
      const Link &to = at(cable.links, i), &from = at(cable.links, before);
      // After a middle link comes the opposite of the row before it: one signed row serves both.
      if (from.pinch_middle && !three) continue;
      if (from.body == to.body && (wound_end(from, to) || is_side(from, to))) continue;
      int a = place_of(parts, s, from.body), b = place_of(parts, s, to.body);
      if (!s.sleeves.empty()) {
        a = place_of_sleeve(world, s, c, before, a);
        b = place_of_sleeve(world, s, c, i, b);
      }
      if (a == b) a = b = s.ground();  // between two points of one body nothing changes
      const int number = append_row(s, a, b);
      s.row_of_segment[begin + index(i)] = number;
      Row& row = s.rows.back();
      row.index = c;
      row.item = i;
      row.turns = !has_fixed_lever(world, cable, before) || !has_fixed_lever(world, cable, i);
      if (!to.pinch_middle || three) continue;
      row.kind = RowKind::pinch_middle;
      s.middles.push_back(number);
    }
  }
  append_sleeve_rows(world, s);
  s.first_contact_row = static_cast<int>(s.rows.size());
}

/// Leaves of a part's rows those of segments, where they are for the same links and kick as before;
/// else lists them.
void begin_segment_rows(const World& world, const Parts& parts, const Part& part, double kick,
                        PartSystem& s) {
  RowsMade made{0, kick};
  for (const int c : cables_of(parts, part)) made.changes += at(world.cables, c).changes;
  const bool again = made == s.made;
  s.made = made;
  s.same_segments = again;
  s.segments_stand = again && !s.mobility_changed;
  s.pressed.clear();
  s.loose.clear();
  s.thirds.clear();
  s.too_long = false;
  if (!again) return list_segment_rows(world, parts, part, s);
  s.rows.resize(index(s.first_contact_row));
  s.bodies.resize(index(s.first_contact_row));
  s.responses.resize(index(s.first_contact_row));
  s.changed.resize(index(s.first_contact_row));
}

/// Whether a segment is in a pinch for good: between circles that never move and leave no gap.
bool is_shut(const Segment& segment, const Link& from, const Link& to) {
  if (!segment.pinched || !from.still || !to.still) return false;
  return (segment.head_centre - segment.tail_centre).norm() <= from.radius + to.radius;
}

/// What a row that has moved, or is new, sees of its bodies.
void place_segment_row(const World& world, const CableState& cable, const Segment& segment,
                       const TimeSpan& interval, bool plain, RowBodies& bodies, Row& row) {
  const int head = row.item, tail = previous_link(cable, head);
  const Link &from = at(cable.links, tail), &to = at(cable.links, head);
  set_segment_bodies(world, cable, tail, head, segment.pinched && yields(cable), bodies);
  row.shut = is_shut(segment, from, to);
  if (plain && segment.pinched) {
    turn_to_centre_line(world, from, to, segment, interval, bodies, row);
  }
}

}  // namespace

int place_of(const Parts& parts, const PartSystem& system, int body) {
  const int local = body >= 0 ? at(parts.local, body) : -1;
  return local >= 0 ? local : system.ground();
}

double restitution_of(const World& world, const Contact& contact) {
  const double other = contact.b >= 0 ? at(world.bodies, contact.b).restitution
                                      : at(world.obstacles, contact.wall).restitution;
  return std::max(at(world.bodies, contact.a).restitution, other);
}

void make_segment_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                       const TimeSpan& interval, PartSystem& s) {
  const bool plain = world.configuration.method == Method::cable;
  const bool exact = locates_events(world.configuration);
  begin_segment_rows(world, parts, part, interval.kick, s);
  Row* const rows = s.rows.data();
  for (int r = 0; r < s.first_sleeve_row; ++r) {
    Row& row = rows[r];
    const CableState& cable = at(world.cables, row.index);
    const Segment& segment = at(cable.segments, row.item);
    set_segment_values(segment, plain, interval, row);
    // Round-off of a pinch's material would add up to motion along a chain of pinched pulleys.
    const bool rounded = segment.pinched && std::abs(row.clearance) <= material_rounding(cable);
    if (exact && rounded) row.bias = 0.0;
    // The lever of a circle off its body's centre turns with the body, moved or not.
    const bool moved = segment.moved || row.turns || row.is_new || (plain && segment.pinched);
    if (moved) {
      place_segment_row(world, cable, segment, interval, plain, at(s.bodies, r), row);
      s.segments_stand = row.is_new = false;
    }
    if (moved || s.mobility_changed) {
      weigh(s, r);
      at(s.changed, r) = true;
    }
    if (row.kind == RowKind::pinch_middle) {
      row.slip = at(cable.links, row.item).slip;
    } else {
      // Where lengths are not exact at the end of a step, what pieces between nodes miss both ways
      // would feed back as speed: there they only pull.
      const bool is_rod = cable.rod && (exact || cable.joint != Joint::none);
      if (is_rod || is_held(cable, index(row.item))) hold_both_ways(interval, row);
      const bool may_stretch = cable.elastic && !row.shut;
      if (may_stretch && !part.may_slide) {
        make_elastic(world, at(scene.cables, row.index), segment, interval, s, r);
      }
      if (segment.pinched && segment.contact >= 0) s.pressed.push_back(r);
      if (row.idle || may_stretch) s.loose.push_back(r);
    }
    if (!(row.clearance >= -interval.made_up) && row.compliance == 0.0) s.too_long = true;
  }
  s.elastic_ends.clear();
  if (!part.may_slide) return;
  note_wraps(world, parts, part, s);
  make_all_elastic(scene, world, parts, part, interval, s);
}

void make_contact_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                       const TimeSpan& interval, PartSystem& s, SolveScratch& scratch) {
  scratch.normal_row_of_contact.resize(world.contacts.size());
  const bool again = s.segments_stand && !part.can_move;  // as the middle bodies' friction was
  if (!again) {
    s.frictions.clear();
    s.repeated.clear();
  }
  for (int r = s.first_sleeve_row; r < s.first_contact_row; ++r) s.loose.push_back(r);
  const std::span<const int> contacts = contacts_of(parts, part);
  for (const int number : contacts) at(scratch.normal_row_of_contact, number) = -1;
  for (const int number : part.can_move ? contacts : std::span<const int>()) {
    const Contact& contact = at(world.contacts, number);
    if (can_give(world, contact)) {
      append_contact_rows(scene, world, parts, number, interval, s, scratch);
    }
  }
  s.same_rows = s.same_segments && index(s.first_contact_row) == s.rows.size();
  s.rows_stand = s.rows_stand && s.same_rows && s.segments_stand;
  if (!s.sleeves.empty()) {
    make_sleeve_rows(scene, world, parts, part, interval, s, scratch);
  }
  if (interval.clamps) {
    for (const int r : s.pressed) clamp_in_pinch(world, scratch, s.reach, at(s.rows, r));
  }
  if (s.middles.empty()) return;
  if (!again) {
    for (const int r : s.middles) add_friction(s, middle_friction(world, s, scratch, r));
    if (world.configuration.solver == Solver::direct) find_repeated_middles(world, s, scratch);
  }
  begin_middles(s);
}

void make_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
               const TimeSpan& interval, PartSystem& s, SolveScratch& scratch, Stopwatch& watch) {
  scratch.step_length = interval.repair;
  scratch.reach = interval.held_only ? -infinity : interval.reach;
  make_segment_rows(scene, world, parts, part, interval, s);
  watch.lap(Stage::init_segments);
  make_contact_rows(scene, world, parts, part, interval, s, scratch);
  watch.lap(Stage::init_contacts);
}

}  // namespace pinchlab
