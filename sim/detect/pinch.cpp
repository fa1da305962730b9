// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/detect/pinch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/joins.h"
#include "sim/cable/links.h"
#include "sim/cable/strung.h"
#include "sim/detect/span_hits.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

double normal_speed(const World& world, const Contact& contact) {
  Vec2 v = -at(world.velocity, contact.a);
  if (contact.b >= 0) v += at(world.velocity, contact.b);
  return contact.normal.dot(v);
}

// What the gap of a pinch may be more than the cable's width, of that. It keeps a pinch that opens
// and closes by the second-order gap of a rolling step: half of what gaps may err by before a
// promise is broken (promises.h), so that what it keeps breaks none.
constexpr double margin = 5e-4;

/// Whether the bodies press what lies between them: they did in the last step, or come together
/// now, or, where that time is not located, in the next step. What is located is as near as the
/// cable is wide then: where a wider one beside it keeps bodies apart it is not touched. A cable
/// that yields is pressed where it is narrower than its width. Round-off of a gap that is closed is
/// below `rounding` of it.
bool presses(const World& world, const CableState& cable, const Contact& contact) {
  constexpr double rounding = 1e-12;
  const double gap = 2.0 * cable.half_width, speed = normal_speed(world, contact);
  if (yields(cable)) return contact.gap <= gap;
  if (contact.gap <= gap * (1.0 + rounding)) return true;
  const bool closes = contact.touching || speed < 0.0;
  if (locates_events(world.configuration)) return closes && contact.gap < gap * (1.0 + margin);
  return contact.touching || contact.gap - gap + world.step_length * speed < 0.0;
}

/// The contact of two bodies, or nothing; `hint` is where it was.
Contact* find_contact(World& world, int body, int other, int hint) {
  const int a = std::min(body, other), b = std::max(body, other);
  if (hint >= 0 && hint < static_cast<int>(world.contacts.size())) {
    Contact& contact = at(world.contacts, hint);
    if (contact.a == a && contact.b == b) return &contact;
  }
  const auto it = std::lower_bound(
      world.contacts.begin(), world.contacts.end(), std::pair(a, b),
      [](const Contact& c, const std::pair<int, int>& p) { return std::pair(c.a, c.b) < p; });
  return it != world.contacts.end() && it->a == a && it->b == b ? &*it : nullptr;
}

/// Of a pair's contacts, one of which is given, the one of the least gap.
Contact* nearest_of_pair(World& world, Contact* one) {
  if (one->touch == Touch::circles) return one;
  const auto of_pair = [one](const Contact& c) { return c.a == one->a && c.b == one->b; };
  const auto begin = world.contacts.begin(), end = world.contacts.end();
  auto first = begin + (one - world.contacts.data());
  while (first != begin && of_pair(*(first - 1))) --first;
  const auto last = std::find_if_not(first, end, of_pair);
  return &*std::min_element(first, last,
                            [](const Contact& p, const Contact& q) { return p.gap < q.gap; });
}

/// m, by which what the other body touches with, a centre or a corner's, is over the centre line of
/// a free span beside link i, on the cable's outer side. Infinity: it is not. Nearer than the
/// cable's width it would press the span against the link's body, so it must keep that distance
/// already before it hits the span. The body that holds the span's far end cannot hit it. What
/// meets the link's own corner may be over a side as well, along which the cable goes on: as it
/// turns, it comes to press the corner, and may be no nearer by then.
double over_adjacent_span(const World& world, const CableState& cable, const Contact& contact,
                          std::size_t i, int other) {
  const bool circles = contact.touch == Touch::circles;
  const Vec2 place = circles ? at(world.position, other) : nearest_place(world, contact, other);
  double least = infinity;
  const auto look = [&](int s, int far_end) {
    if (holds_span(world, cable, at(cable.links, far_end), other)) return;
    const Segment& segment = at(cable.segments, s);
    const Vec2 x = place - segment.tail;
    const double along = segment.direction.dot(x);
    const double over = -cross(segment.direction, x) * cable.links[i].orientation;
    if (segment.pinched || !(along > 0.0 && along < segment.length && over > 0.0)) return;
    least = std::min(least, over);
  };
  const int link = static_cast<int>(i);
  const int before = previous_link(cable, link), after = next_link(cable, link);
  const Link &tail = at(cable.links, before), &head = at(cable.links, after);
  const int owner = contact.touch == Touch::point_of_a ? contact.a : contact.b;
  const bool own_corner = !circles && owner != other && contact.point == cable.links[i].corner;
  if (own_corner || tail.moored || !is_side(tail, cable.links[i])) look(link, before);
  if (own_corner || head.moored || !is_side(cable.links[i], head)) look(after, after);
  if (tail.moored) look(before, previous_link(cable, before));
  if (head.moored) look(next_link(cable, after), next_link(cable, after));
  return least;
}

/// Whether direction u from the body's centre surely misses the cable on link i, of less than half
/// a turn: by the signs of sin(arc) and sin(wrap - arc), with the tolerance.
bool off_arc(const CableState& cable, std::size_t i, const Vec2& u) {
  const Link& link = cable.links[i];
  const int after = next_link(cable, static_cast<int>(i));
  const Vec2& arrives = cable.segments[i].direction;
  const Vec2& leaves = at(cable.segments, after).direction;
  const Vec2 e = link.orientation * left(u);  // direction of the cable at that point of the surface
  const double after_tail = link.orientation * cross(arrives, e);
  const double before_head = link.orientation * cross(e, leaves);
  return after_tail < -arc_tolerance || before_head < -arc_tolerance;
}

/// m, that bodies which press a cable there leave between them.
double gap_for(const CableState& cable, const Link& link) {
  return cable.least_gap + thickness_of_layers(link);
}

// As a share: gaps for cables that are as wide.
constexpr double same_gap = 1e-12;

/// Leaves nothing of what is said of cables that are pressed without a link of their own for it.
void forget_pressed(Contact& contact) {
  contact.pressed_friction = 0.0;
  contact.layers_cable = contact.slipping_cable = -1;
}

/// A drum's layers keep others out as far as the outermost reaches. No cable comes between bodies
/// that have been nearer than its width: it would move them apart at once. It passes in front of
/// what they touch with, and comes between when they have parted so far. Whether it does.
bool note_cable_between(const World& world, const CableState& cable, const Link& link,
                        Contact& contact) {
  const double least = gap_for(cable, link);
  if (cable.least_gap > 0.0) {
    const bool located = locates_events(world.configuration);
    if (contact.bare && located && contact.gap < least * (1.0 - margin)) return false;
    if (least > contact.target * (1.0 + same_gap)) forget_pressed(contact);
    contact.target = std::max(contact.target, least);
  }
  contact.cable_between = static_cast<int>(&cable - world.cables.data());
  return true;
}

/// The same for a cable that has no link of its own for what presses it on to a polygon, or with a
/// polygon, or on to layers. What presses rolls on it, or rubs on it: as on the link's body where
/// that holds the cable without slip, and else as solve/friction.h has it. Of cables the widest is
/// touched. Of those of one width, of turns that lie there one above another, and of the corners at
/// both ends of a side, the first counts. The thesis' sweeps and rows press what may slip without
/// friction.
void note_cable_held(const World& world, const CableState& cable, const Link& link, int presser,
                     Contact& contact) {
  if (!note_cable_between(world, cable, link, contact)) return;
  if (gap_for(cable, link) < contact.target * (1.0 - same_gap)) return;
  const int number = static_cast<int>(&cable - world.cables.data());
  if (link.layers.way != 0) contact.layers_cable = number;
  if (at(world.bodies, link.body).cable_friction < infinity) {
    const Configuration& how = world.configuration;
    if (how.solver != Solver::direct || how.pinch_rows != PinchRows::one) return;
    if (link.layers.way != 0 || contact.slipping_cable >= 0) return;
    contact.slipping_cable = number;
    contact.slips_on = link.body;
    contact.slips_way = static_cast<std::int8_t>(link.orientation);
    contact.slips_corner = link.corner;
  }
  const double mu = friction_in_pinch(world, cable, presser);
  contact.pressed_friction = std::max(contact.pressed_friction, mu);
}

/// Keeps a polygon and what is over a free span beside it apart. Where the span lies along a side,
/// what stands there on it presses it, which is no hit: it is in it by no more than round-off.
void keep_off_span(const World& world, const CableState& cable, const Link& link, int other,
                   double over, Contact& contact) {
  constexpr double rounding = 1e-6;  // of the half width, far above what grazes (span_hits.h)
  if (over == infinity) return;
  const double apart = over - rim_radius(at(world.bodies, other));
  const bool touches = std::abs(apart - cable.half_width) <= rounding * cable.half_width;
  if (touches && presses(world, cable, contact)) {
    note_cable_held(world, cable, link, other, contact);
  } else {
    note_cable_between(world, cable, link, contact);
  }
}

/// Whether what touches a side of the polygon of link i, which ends at the link's corner, does so
/// where the cable has left the side, or has not come to it: there it is a free span, however near
/// in direction. What lies between it and the side has no cable between, as the tip of the next
/// body that the span runs to; nor what touches the side beyond the span.
bool off_side(const World& world, const CableState& cable, const Contact& contact, std::size_t i) {
  const Link& link = cable.links[i];
  const Vec2 x =
      nearest_place(world, contact, link.body) - place_of_point(world, link.body, link.corner);
  // Of the body's radius: nearer to the corner, the way from it is round-off and has no direction.
  constexpr double at_corner = 1e-9;
  const double distance = x.norm();
  if (distance <= at_corner * at(world.bodies, link.body).radius) return false;
  const int before = previous_link(cable, static_cast<int>(i));
  const int after = next_link(cable, static_cast<int>(i));
  const double along = distance * std::cos(2.0 * arc_tolerance);
  if (-cable.segments[i].direction.dot(x) > along) {
    return !is_side(at(cable.links, before), link);
  }
  return at(cable.segments, after).direction.dot(x) > along &&
         !is_side(link, at(cable.links, after));
}

/// Whether a contact of a polygon has the cable on link i between its bodies.
bool presses_arc(const World& world, const CableState& cable, const Contact& contact, std::size_t i,
                 const Vec2& u) {
  const Link& link = cable.links[i];
  // What touches with a corner does so there; where something touches its side, `u` tells.
  const int owner = contact.touch == Touch::point_of_a ? contact.a : contact.b;
  if (link.body == owner && link.corner >= 0 && link.corner != contact.point) return false;
  if (link.wrap < std::numbers::pi && off_arc(cable, i, u)) return false;
  if (link.body != owner && link.corner >= 0 && off_side(world, cable, contact, i)) return false;
  return arc_of_direction(cable, i, u) <= link.wrap + arc_tolerance;
}

/// The turns of link i that `contact` presses, apart from the end at which the other body is the
/// cable's next or previous one (there the pinch is transitional or made already).
void find_pinches_on(const World& world, const CableState& cable, Contact& contact, std::size_t i,
                     int other, const Vec2& u, std::vector<NewPinch>& found) {
  const Link& link = cable.links[i];
  const int before = previous_link(cable, static_cast<int>(i));
  const int after = next_link(cable, static_cast<int>(i));
  const auto is_other = [&](int neighbour) {
    return neighbour >= 0 && at(cable.links, neighbour).body == other &&
           opposite(at(cable.links, neighbour), link);
  };
  constexpr double near_end = 1.0;  // rad; turns lie 2 pi apart
  const bool after_other = is_other(before), before_other = is_other(after);
  const bool few = link.wrap < std::numbers::pi;  // less than half a turn: no other turn is near
  if (few && ((after_other && cable.segments[i].pinched) ||
              (before_other && at(cable.segments, after).pinched))) {
    return;  // the pinch is there
  }
  if (cable.least_gap > 0.0 && over_adjacent_span(world, cable, contact, i, other) < infinity) {
    note_cable_between(world, cable, link, contact);
  }
  if (few && (after_other || before_other || off_arc(cable, i, u))) return;
  const double least = arc_of_direction(cable, i, u), turn = 2.0 * std::numbers::pi;
  // What lies beyond the very end of the arc by the angle x is that much in the span,
  //     D x^2 / 2,    D the distance of the centres,
  // and has a link of its own where that is no graze. Up to twice the angle at which it is one it
  // presses the end of the arc; so does a body that has just lost its own link. No frame shows it.
  const double end = locates_events(world.configuration) ? 2.0 * std::sqrt(2.0 * graze) : 0.0;
  const double wrap = std::max(link.wrap, 0.0);
  for (int k = 0; least + k * turn <= link.wrap + arc_tolerance; ++k) {
    double arc = least + k * turn;
    if (arc < 0.0 && arc > -end) arc = 0.0;
    if (arc > wrap && arc < wrap + end) arc = wrap;
    if (after_other && arc < near_end) continue;
    if (before_other && link.wrap - arc < near_end) continue;
    if (link.layers.way != 0) {  // they are held as they lie
      note_cable_held(world, cable, link, other, contact);
      return;
    }
    if (!note_cable_between(world, cable, link, contact)) return;
    if (arc >= 0.0 && arc <= wrap && presses(world, cable, contact)) {
      found.push_back({static_cast<int>(i), arc, other});
    }
  }
}

/// Middle links whose bodies have parted from the cable.
void remove_open_pinches(World& world, const Workspace& work) {
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    if (work.contacts.stands[c] || is_idle(work.parts, c)) continue;
    CableState& cable = world.cables[c];
    for (int i = static_cast<int>(cable.links.size()) - 1; i >= 0; --i) {
      const Link& link = at(cable.links, i);
      if (!link.pinch_middle) continue;
      const int pressed = at(cable.links, previous_link(cable, i)).body;
      const Contact* contact = find_contact(world, link.body, pressed, link.contact);
      const double width = 2.0 * cable.half_width;
      if (contact == nullptr ||
          (!presses(world, cable, *contact) && contact->gap > width * (1.0 + margin))) {
        leave_body(world, cable, i);
      }
    }
  }
}

/// Whether neither body of a contact has moved.
bool is_kept(const Parts& parts, const Contact& contact) {
  return is_still(parts, contact.a) && (contact.b < 0 || is_still(parts, contact.b));
}

/// Lists the cables that stand, in parts all of whose contacts do: their pinches are what they were
/// when they were configured last. What has moved elsewhere does not matter to them.
void find_standing_cables(const World& world, const Parts& parts, ContactScratch& scratch) {
  scratch.stands.assign(world.cables.size(), false);
  if (parts.list.empty() || scratch.configured_changes != world.changes) return;
  scratch.stirred.assign(parts.list.size(), false);
  for (const Contact& contact : world.contacts) {
    if (is_kept(parts, contact)) continue;
    for (const int body : {contact.a, contact.b}) {
      if (body < 0) continue;
      const int part = at(parts.of_body, body);
      if (part < 0 && contact.b >= 0) return;  // static: cables of any part may run over it
      if (part >= 0) at(scratch.stirred, part) = true;
    }
  }
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    scratch.stands[c] = world.cables[c].stands && !at(scratch.stirred, parts.of_cable[c]);
  }
}

/// Likewise those of parts that wait.
void find_waiting_cables(const Parts& parts, ContactScratch& scratch) {
  for (std::size_t c = 0; c < scratch.stands.size(); ++c) {
    if (at(parts.list, parts.of_cable[c]).waits) scratch.stands[c] = true;
  }
}

/// Whether a cable may lie between a contact's bodies: cables do not touch cables, so those pass
/// through nodes, which come to lie on what a cable runs over as if it were not there.
bool may_pinch(const World& world, const Contact& contact) {
  return contact.b >= 0 && !at(world.bodies, contact.a).node && !at(world.bodies, contact.b).node;
}

/// Only links of bodies that have contacts matter.
void list_contacts_of_bodies(const World& world, ContactScratch& scratch) {
  Lists<int>& lists = scratch.contacts_of_body;
  lists.begin.assign(world.bodies.size() + 1, 0);
  for (const Contact& c : world.contacts) {
    if (!may_pinch(world, c)) continue;
    ++at(lists.begin, c.a + 1);
    ++at(lists.begin, c.b + 1);
  }
  for (std::size_t b = 0; b < world.bodies.size(); ++b) lists.begin[b + 1] += lists.begin[b];
  lists.items.resize(index(lists.begin.back()));
  scratch.fill = lists.begin;
  for (std::size_t i = 0; i < world.contacts.size(); ++i) {
    const Contact& c = world.contacts[i];
    if (!may_pinch(world, c)) continue;
    for (const int body : {c.a, c.b}) {
      at(lists.items, at(scratch.fill, body)++) = static_cast<int>(i);
    }
  }
}

}  // namespace

void configure_pinches(World& world, Workspace& work) {
  if (world.configuration.method == Method::cable) return;
  if (world.contacts.empty() && work.contacts.old_contacts.empty()) return;
  ContactScratch& scratch = work.contacts;
  scratch.pinches_kept =
      scratch.contacts_kept && !work.spans_moved && scratch.configured_changes == world.changes;
  if (scratch.pinches_kept) return;
  find_standing_cables(world, work.parts, scratch);
  if (work.neighbourhoods.divided) find_waiting_cables(work.parts, scratch);
  const auto& stands = scratch.stands;
  if (std::find(stands.begin(), stands.end(), false) == stands.end()) return;
  remove_open_pinches(world, work);

  list_contacts_of_bodies(world, scratch);
  const Lists<int>& lists = scratch.contacts_of_body;
  std::vector<NewPinch> found;  // allocates only when a pinch is made
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    if (scratch.stands[c]) continue;
    CableState& cable = world.cables[c];
    found.clear();
    for (std::size_t i = 0; i < cable.links.size(); ++i) {
      const Link& link = cable.links[i];
      if (link.orientation == 0 || link.pinch_middle) continue;
      const int after = next_link(cable, static_cast<int>(i));
      const bool moved = cable.segments[i].moved || at(cable.segments, after).moved;
      for (int k = at(lists.begin, link.body); k < at(lists.begin, link.body + 1); ++k) {
        Contact& contact = at(world.contacts, at(lists.items, k));
        if (!moved && is_kept(work.parts, contact)) continue;
        const bool is_a = contact.a == link.body;
        const int other = is_a ? contact.b : contact.a;
        if (cable.nodes > 0 && holds_end_inside(world, cable, other)) continue;
        const Vec2 u = is_a ? contact.normal : Vec2(-contact.normal);
        if (contact.touch == Touch::circles) {
          find_pinches_on(world, cable, contact, i, other, u, found);
        } else if (presses_arc(world, cable, contact, i, u)) {
          note_cable_held(world, cable, link, other, contact);
        } else {
          const double over = over_adjacent_span(world, cable, contact, i, other);
          keep_off_span(world, cable, link, other, over, contact);
        }
      }
    }
    if (found.empty()) continue;
    std::sort(found.begin(), found.end(), [](const NewPinch& p, const NewPinch& q) {
      return std::tie(p.link, p.arc, p.body) < std::tie(q.link, q.arc, q.body);
    });
    insert_pinches(world, cable, found);
  }
  scratch.configured_changes = world.changes;
}

namespace {

/// A cable that runs from a node moored to one body to another, or to a node moored there, is
/// between the two.
void note_cable_beside_moored(World& world, const CableState& cable, std::size_t segment) {
  const auto on = [&cable](int link) -> const Link& {
    return at(cable.links, at(cable.links, link).moored ? rim_of(cable, link) : link);
  };
  const int head = static_cast<int>(segment);
  const Link &from = on(previous_link(cable, head)), &to = on(head);
  if (!opposite(from, to) || from.body == to.body) return;
  Contact* contact = find_contact(world, from.body, to.body, -1);
  if (contact == nullptr) return;
  contact = nearest_of_pair(world, contact);
  note_cable_between(world, cable, from, *contact);
  note_cable_between(world, cable, to, *contact);
}

/// assign_contacts, of one part.
void assign_contacts(World& world, const Parts& parts, const Part& part) {
  for (const int i : contacts_of(parts, part)) at(world.contacts, i).pinch_points = 0;
  for (const int c : cables_of(parts, part)) {
    CableState& cable = at(world.cables, c);
    for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
      Link& to = cable.links[s];
      const auto tail = index(previous_link(cable, static_cast<int>(s)));
      const Link& from = cable.links[tail];
      Segment& segment = cable.segments[s];
      if (from.moored || to.moored) {
        note_cable_beside_moored(world, cable, s);
        continue;
      }
      const int hint = to.pinch_middle ? to.contact : segment.contact;
      segment.contact = to.contact = -1;
      if (!opposite(from, to) || from.pinch_middle) continue;
      Contact* contact = find_contact(world, from.body, to.body, hint);
      if (contact == nullptr) continue;
      contact = nearest_of_pair(world, contact);
      note_cable_between(world, cable, from, *contact);
      note_cable_between(world, cable, to, *contact);
      const bool is_thin = contact->gap > 2.0 * cable.half_width * (1.0 + margin);
      if (!to.pinch_middle && !segment.pinched && is_thin) continue;  // another one is pressed
      const int index = static_cast<int>(contact - world.contacts.data());
      ++contact->pinch_points;
      if (to.pinch_middle) {
        to.contact = index;
      } else {
        segment.contact = index;
      }
    }
  }
}

/// Whether the part's contacts and pinches are those of the step before, in the same places.
bool pinches_stand(const Workspace& work, const Part& part) {
  if (work.parts.divided) return false;
  const std::span<const int> cables = cables_of(work.parts, part);
  return std::all_of(cables.begin(), cables.end(),
                     [&work](int c) { return at(work.contacts.stands, c) != 0; });
}

}  // namespace

void assign_contacts(World& world, const Workspace& work) {
  if (world.configuration.method == Method::cable) return;
  if (world.contacts.empty() && work.contacts.old_contacts.empty()) return;
  if (work.contacts.pinches_kept) return;
  const Parts& parts = work.parts;
  for (const Part& part : parts.list) {
    if (!part.kept && !pinches_stand(work, part)) assign_contacts(world, parts, part);
  }
}

}  // namespace pinchlab
