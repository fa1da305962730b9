// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/friction.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/parts.h"
#include "sim/solve/solve_scratch.h"

namespace pinchlab {

namespace {

/// With three rows the middle body of a pinch holds the cable like an arc of this much on it (rad).
constexpr double middle_arc = 1.0;

double capstan_factor(double mu, double arc) {
  return std::exp(std::min(mu * arc, largest_exponent));
}

/// The transitional pinch of a segment, as seen by a body whose friction there is mu at one of its
/// ends.
void append_pressed_end(const World& world, const SolveScratch& scratch, const Segment& segment,
                        double mu, std::vector<Passage>& passages) {
  if (segment.contact < 0 || mu == 0.0) return;
  const Press press = press_of(world, scratch, segment.contact, mu);
  Passage passage;
  passage.normal = press.normal;
  passage.friction = press.friction;
  passages.push_back(passage);
}

/// Where on a link (rad after its tail) a contact presses its cable, which may slip there.
double arc_of_press(const CableState& cable, int link, const Contact& contact, double wrap) {
  const Vec2 outward = contact.slips_on == contact.a ? contact.normal : Vec2(-contact.normal);
  return std::clamp(arc_of_direction(cable, index(link), outward), 0.0, wrap);
}

/// The pinch that a contact makes, which has no link of its own.
Passage passage_of_press(const World& world, PartSystem& system, const SolveScratch& scratch,
                         int contact, double mu, int run) {
  const Press press = press_of(world, scratch, contact, mu);
  Passage pinch;
  pinch.normal = press.normal;
  pinch.friction = press.friction;
  if (press.normal < 0) return pinch;
  const int next = tangent_row_of(system, press.normal);
  if (next < 0) return pinch;
  Friction& friction = at(system.frictions, at(system.rows, next).friction);
  if (friction.run >= 0) return pinch;  // of another turn, which it rubs on
  friction.run = run;
  pinch.middle = next;
  return pinch;
}

/// A link's arc of `wrap` (rad), cut where contacts press its cable.
void append_arc(const World& world, PartSystem& system, SolveScratch& scratch, int number, int link,
                double wrap, int run, std::vector<Passage>& passages) {
  const CableState& cable = at(world.cables, number);
  const int body = at(cable.links, link).body;
  const double mu = at(world.bodies, body).cable_friction;
  find_cuts(world, scratch.capstan.pressing, number, link, wrap, scratch.capstan.cuts);
  double passed = 0.0;  // rad
  const auto pass_until = [&](double arc) {
    Passage passage;
    passage.factor = capstan_factor(mu, arc - passed);
    passages.push_back(passage);
    passed = arc;
  };
  for (const ArcCut& cut : scratch.capstan.cuts) {
    pass_until(cut.arc);
    const double pressed_mu = friction_in_pinch(world, cable, body);
    passages.push_back(passage_of_press(world, system, scratch, cut.contact, pressed_mu, run));
  }
  pass_until(wrap);
}

}  // namespace

void list_pressing(const World& world, const Parts& parts, const Part& part,
                   std::vector<int>& pressing) {
  pressing.clear();
  for (const int k : contacts_of(parts, part)) {
    if (at(world.contacts, k).slipping_cable >= 0) pressing.push_back(k);
  }
}

bool presses(const Contact& contact, int cable, const Link& link) {
  return contact.slipping_cable == cable && contact.pinch_points == 0 &&
         contact.slips_on == link.body && contact.slips_corner == link.corner &&
         contact.slips_way == link.orientation;
}

void find_cuts(const World& world, const std::vector<int>& pressing, int cable, int link,
               double wrap, std::vector<ArcCut>& cuts) {
  cuts.clear();
  const CableState& of = at(world.cables, cable);
  for (const int k : pressing) {
    const Contact& contact = at(world.contacts, k);
    if (!presses(contact, cable, at(of.links, link))) continue;
    cuts.push_back({arc_of_press(of, link, contact, wrap), k});
  }
  std::sort(cuts.begin(), cuts.end());
}

int tangent_row_of(const PartSystem& system, int normal) {
  const auto next = index(normal) + 1;
  const bool has = next < system.rows.size() && system.rows[next].kind == RowKind::tangent;
  return has ? static_cast<int>(next) : -1;
}

double share(double mu, const Contact& contact) {
  return mu / std::max(1, contact.pinch_points);
}

Press press_of(const World& world, const SolveScratch& scratch, int contact, double mu) {
  if (contact < 0) return {};
  return {at(scratch.normal_row_of_contact, contact), share(mu, at(world.contacts, contact))};
}

double contact_coefficient(double mu_a, double mu_b) {
  return std::sqrt(mu_a * mu_b);
}

double coefficient_of(const World& world, const Contact& contact) {
  if (contact.cable_between >= 0) return contact.pinch_points == 0 ? contact.pressed_friction : 0.0;
  const double other = contact.b >= 0 ? at(world.bodies, contact.b).contact_friction
                                      : at(world.obstacles, contact.wall).contact_friction;
  return contact_coefficient(at(world.bodies, contact.a).contact_friction, other);
}

Friction contact_friction(int row, int normal, double coefficient) {
  Friction friction;
  friction.row = row;
  friction.normal = normal;
  friction.coefficient = coefficient;
  return friction;
}

Friction middle_friction(const World& world, const PartSystem& system, const SolveScratch& scratch,
                         int number) {
  const Row& row = at(system.rows, number);
  const CableState& cable = at(world.cables, row.index);
  const Link& middle = at(cable.links, row.item);
  const Link& wrapped = at(cable.links, previous_link(cable, row.item));
  const Contact* contact = middle.contact >= 0 ? &at(world.contacts, middle.contact) : nullptr;
  const int normal = contact ? at(scratch.normal_row_of_contact, middle.contact) : -1;
  const bool clamped = contact && (normal < 0 || at(system.rows, normal).diagonal == 0.0);
  const double mu = friction_in_pinch(world, cable, middle.body);
  Friction friction;
  friction.row = number;
  const bool held = clamped || yields(cable);  // however little a soft sheath presses
  if (mu == infinity && held) {
    friction.coefficient = infinity;
    return friction;
  }
  if (clamped || normal < 0) return friction;
  friction.normal = normal;
  friction.coefficient = share(mu, *contact);
  friction.wrapped = share(friction_in_pinch(world, cable, wrapped.body), *contact);
  return friction;
}

void find_repeated_middles(const World& world, PartSystem& s, SolveScratch& scratch) {
  std::vector<int>& first_middle = scratch.middle_row_of_contact;
  first_middle.resize(world.contacts.size());
  const auto contact_of = [&world](const Row& row) {
    return at(at(world.cables, row.index).links, row.item).contact;
  };
  const auto may_repeat = [&](const Friction& friction) {
    const Row& row = at(s.rows, friction.row);
    if (row.kind != RowKind::pinch_middle || friction.coefficient < infinity) return false;
    const int contact = contact_of(row);
    return contact >= 0 && at(world.contacts, contact).pinch_points > 1;
  };
  for (const Friction& friction : s.frictions) {
    if (may_repeat(friction)) at(first_middle, contact_of(at(s.rows, friction.row))) = -1;
  }
  for (Friction& friction : s.frictions) {
    if (!may_repeat(friction)) continue;
    int& first = at(first_middle, contact_of(at(s.rows, friction.row)));
    if (first < 0) {
      first = friction.row;
      continue;
    }
    const RowBodies &row = at(s.bodies, friction.row), &other = at(s.bodies, first);
    const bool same_side = row.a == other.a;
    const Eigen::Vector3d& j = same_side ? other.ja : other.jb;
    const Eigen::Vector3d& k = same_side ? other.jb : other.ja;
    const double sign = row.ja.dot(j) > 0.0 ? 1.0 : -1.0;
    const double difference =
        (row.ja - sign * j).cwiseAbs().maxCoeff() + (row.jb - sign * k).cwiseAbs().maxCoeff();
    // Cables of different widths have different levers; equal ones differ by round-off.
    constexpr double rounding = 1e-12;
    const double size = std::max(j.cwiseAbs().maxCoeff(), k.cwiseAbs().maxCoeff());
    if (difference > rounding * size) continue;
    friction.repeats = first;
    friction.opposes = sign < 0.0;
    ++at(s.frictions, at(s.rows, first).friction).repeated;
  }
  for (std::size_t i = 0; i < s.frictions.size(); ++i) {
    const Friction& friction = s.frictions[i];
    if (friction.repeated > 0 || friction.repeats >= 0) s.repeated.push_back(static_cast<int>(i));
  }
}

void share_among_repeated(PartSystem& s) {
  for (const int number : s.repeated) {
    const Friction& friction = at(s.frictions, number);
    Row& row = at(s.rows, friction.row);
    if (friction.repeated > 0) row.impulse /= 1 + friction.repeated;
    if (friction.repeats < 0) continue;
    const double of_first = at(s.rows, friction.repeats).impulse;  // before, and has its share
    row.impulse = friction.opposes ? -of_first : of_first;
  }
}

void note_wraps(const World& world, const Parts& parts, const Part& part, PartSystem& system) {
  system.wraps.clear();
  for (const int c : cables_of(parts, part)) {
    for (const Link& link : at(world.cables, c).links) {
      system.wraps.push_back(std::max(link.wrap, 0.0));
    }
  }
}

void append_passages(const World& world, PartSystem& system, SolveScratch& scratch,
                     int cable_number, int first, int last, int begin, int run,
                     std::vector<Passage>& passages) {
  const int* row_of_segment = system.row_of_segment.data() + begin;
  const CableState& cable = at(world.cables, cable_number);
  const double pinched_mu = friction_in_pinch(world, cable, at(cable.links, first).body);
  const bool three = world.configuration.pinch_rows == PinchRows::three;
  const auto passage_of_middle = [&](int i) {
    const Link& middle = at(cable.links, i);
    Passage passage;
    if (first == last) {
      passage.factor = capstan_factor(pinched_mu, middle_arc);
      return passage;
    }
    passage.middle = row_of_segment[i];
    if (three) {
      passage.middle_out = row_of_segment[next_link(cable, i)];
      passage.middle_factor =
          capstan_factor(friction_in_pinch(world, cable, middle.body), middle_arc);
    } else {
      at(system.frictions, at(system.rows, passage.middle).friction).run = run;
      const Press press = press_of(world, scratch, middle.contact, pinched_mu);
      passage.normal = press.normal;
      passage.friction = press.friction;
    }
    return passage;
  };
  if (!three) append_pressed_end(world, scratch, at(cable.segments, first), pinched_mu, passages);
  for (int i = first;; i = next_link(cable, i)) {
    if (at(cable.links, i).pinch_middle) {
      passages.push_back(passage_of_middle(i));
    } else {
      append_arc(world, system, scratch, cable_number, i, at(system.wraps, begin + i), run,
                 passages);
    }
    if (i == last) break;
  }
  if (three) return;
  const int after = next_link(cable, last);
  append_pressed_end(world, scratch, at(cable.segments, after), pinched_mu, passages);
}

}  // namespace pinchlab
