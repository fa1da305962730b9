// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/taking_in.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/joins.h"
#include "sim/cable/mass.h"
#include "sim/cable/strung.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

// The header has the reasons.
constexpr double most_bent = 0.5;  // rad, more than when it was moored
constexpr double taken_in = 1e-2;  // of the distance of nodes
constexpr double taken_in_creeping = 0.1;

/// rad, by which the cable turns at a node.
double turn_at(const CableState& cable, int link) {
  return alpha_head(cable, index(link)) - at(cable.segments, link).alpha;
}

/// Turns all that follows a node by so many whole turns, and what it rolls on with it: nothing
/// changes but how turns are counted.
void count_turns_off(CableState& cable, int link, double turns) {
  const double angle = 2.0 * std::numbers::pi * turns;
  for (std::size_t i = index(link) + 1; i < cable.links.size(); ++i) {
    cable.segments[i].alpha -= angle;
    cable.segments[i].alpha_before -= angle;
    Link& after = cable.links[i];
    if (after.layers.way != 0) {
      after.layers.begins -= after.orientation * angle;
    } else if (!cable.rims.empty() && !cable.rims[i].laid.empty()) {
      for (Laid& laid : cable.rims[i].laid) laid.place -= after.signed_radius() * angle;
    } else {
      after.material += after.signed_radius() * angle;
    }
  }
  if (cable.closed) cable.turning -= angle;
}

/// rad, by which the cable is bent away from a rim at a node beside it: up to somewhat more than
/// half a turn, so that one that folds back on the rim is bent away, whatever round-off does.
double bent_away(const CableState& cable, int link, int rim) {
  const double bent = -at(cable.links, rim).orientation * turn_at(cable, link);
  return std::remainder(bent - most_bent, 2.0 * std::numbers::pi) + most_bent;
}

/// Counts turns anew from a node on, so that the cable bends there as bent_away has it; by less
/// than half a turn where there is no rim (-1).
void count_bend_anew(CableState& cable, int link, int rim) {
  const double turn = turn_at(cable, link), whole = 2.0 * std::numbers::pi;
  const double bend = rim < 0 ? std::remainder(turn, whole)
                              : -at(cable.links, rim).orientation * bent_away(cable, link, rim);
  const double turns = std::round((turn - bend) / whole);
  if (turns != 0.0) count_turns_off(cable, link, turns);
}

/// rad, by which what holds a moored node is turned.
double turned_by(const World& world, const Link& moored) {
  return at(world.angle, moored.body) + moored.slid;
}

/// What is left until a moored node is in line with the rim's tangent; and until it comes off (m,
/// on the rim).
struct LeftOfMooring {
  double in_line, off;
};
LeftOfMooring left_of_mooring(const World& world, const CableState& cable, int link) {
  const Link& moored = at(cable.links, link);
  const int held_by = rim_of(cable, link);
  const Link& rim = at(cable.links, held_by);
  const double bent = bent_away(cable, link, held_by);
  const double back =
      std::remainder(turned_by(world, moored) - moored.held, 2.0 * std::numbers::pi);
  const double given =
      (held_by == previous_link(cable, link) ? 1 : -1) * rim.signed_radius() * back;
  return {rim.radius * bent, std::min(taken_in * node_spacing(cable) - given,
                                      rim.radius * (moored.bent + most_bent - bent))};
}

}  // namespace

double mooring_distance(const CableState& cable) {
  const double share = cable.rims.empty() ? taken_in : taken_in_creeping;
  return std::max(share * node_spacing(cable), cable.fills ? cable.half_width : 0.0);
}

double left_until_taken_in(const World& world, const CableState& cable, int link) {
  if (at(cable.links, link).moored) {
    const LeftOfMooring left = left_of_mooring(world, cable, link);
    return std::min(left.in_line, left.off);
  }
  double least = infinity;
  const auto look = [&](int segment, int beyond) {
    if (at(cable.links, beyond).orientation == 0) return;
    const Segment& span = at(cable.segments, segment);
    least = std::min({least, span.rest_length, span.length});
  };
  look(link, previous_link(cable, link));
  const int after = next_link(cable, link);
  look(after, after);
  return least - mooring_distance(cable);
}

namespace {

/// The nearer one of the rims beside a node, or -1.
int nearest_rim(const CableState& cable, int link) {
  int nearest = -1;
  double least = infinity;
  for (const bool before : {true, false}) {
    const int beyond = before ? previous_link(cable, link) : next_link(cable, link);
    const Segment& span = at(cable.segments, before ? link : beyond);
    const double left = std::min(span.rest_length, span.length);
    if (at(cable.links, beyond).orientation == 0 || left >= least) continue;
    least = left;
    nearest = beyond;
  }
  return nearest;
}

/// Puts a node as near to a rim as its cable reaches, where lengths have not been met: once it is
/// moored nothing puts that right. What can stretch is stretched.
void draw_near(World& world, CableState& cable, int link, int rim) {
  if (cable.elastic) return;
  const bool before = rim == previous_link(cable, link);
  const Segment& arm = at(cable.segments, before ? link : rim);
  const double excess = arm.length - arm.rest_length;
  if (!(excess > 0.0)) return;
  at(world.position, at(cable.links, link).body) += (before ? -excess : excess) * arm.direction;
  update_tangent(world, cable, index(link));
  update_tangent(world, cable, index(next_link(cable, link)));
}

/// Where a node's link has come to be on another body, at the same place.
void note_change(World& world, CableState& cable, int link) {
  update_tangent(world, cable, index(link));
  update_tangent(world, cable, index(next_link(cable, link)));
  count_changes(world, cable, 1);
  update_wraps_and_rest_lengths(world, cable);
}

}  // namespace

bool is_to_be_moored(const CableState& cable, int link) {
  const Link& before = at(cable.links, previous_link(cable, link));
  const Link& after = at(cable.links, next_link(cable, link));
  if (before.body == after.body && opposite(before, after)) return true;  // it folds back there
  const int rim = nearest_rim(cable, link);
  if (rim < 0) return false;  // it has come off at the same time
  return bent_away(cable, link, rim) > 0.0;
}

bool is_to_be_cast_off(const World& world, const CableState& cable, int link) {
  const LeftOfMooring left = left_of_mooring(world, cable, link);
  return left.off < left.in_line;
}

void moor_node(World& world, CableState& cable, int link) {
  const int rim = nearest_rim(cable, link), node = at(cable.links, link).body;
  draw_near(world, cable, link, rim);
  count_bend_anew(cable, link, rim);
  join_rim(world, cable, link, rim);
  lay_down_node(world, node);
  Link& moored = at(cable.links, link);
  moored.bent = bent_away(cable, link, rim);
  moored.held = turned_by(world, moored);
  Segment& arm = at(cable.segments, rim == previous_link(cable, link) ? link : rim);
  arm.tension = 0.0;
  arm.slack = false;
  note_change(world, cable, link);
}

int cast_off_node(World& world, CableState& cable, int link) {
  Link& moored = at(cable.links, link);
  const int node = node_of(cable, moored);
  const Vec2 x = link_centre(world, moored);
  const Vec2 z = left(Vec2(x - pivot_of_link(world, cable, link)));
  free_node(world, node, x, velocity_at(world, cable, link, z));
  moored.body = node;
  moored.corner = -1;
  moored.offset = Vec2::Zero();
  moored.moored = false;
  moored.slid = 0.0;
  note_change(world, cable, link);
  return node;
}

void take_in_node(World& world, CableState& cable, int link) {
  if (at(cable.links, link).moored) {
    count_bend_anew(cable, link, rim_of(cable, link));
    leave_body(world, cable, link);
    return;
  }
  const int body = at(cable.links, link).body;
  for (const int beside : {link, next_link(cable, link)}) {
    if (is_held(cable, index(beside))) let_go(world, cable, index(beside));
  }
  count_bend_anew(cable, link, nearest_rim(cable, link));
  leave_node(world, cable, link);
  lay_down_node(world, body);
}

bool take_in_enclosed_nodes(World& world, CableState& cable) {
  bool any = false;
  for (int i = 0; index(i) < cable.links.size(); ++i) {
    const Link& from = at(cable.links, i);
    int next = next_link(cable, i), nodes = 0, moored = 0;
    const auto is_node = [&cable](const Link& link) {
      return is_strung(cable, link) || link.moored;
    };
    while (next >= 0 && is_node(at(cable.links, next)) && nodes < cable.nodes) {
      if (at(cable.links, next).moored) ++moored;
      next = next_link(cable, next);
      ++nodes;
    }
    if (nodes == 0 || next < 0 || from.orientation == 0) continue;
    const Link& to = at(cable.links, next);
    if (to.body != from.body || to.orientation != from.orientation) continue;  // back past its side
    const bool lies = from.corner >= 0 || from.layers.way != 0 || to.layers.way != 0;
    if (!lies && moored == 0) continue;  // they are drawn on to the disc
    take_in_node(world, cable, next_link(cable, i));
    ++world.diagnostics.node_changes;
    any = true;
    i = -1;  // links have other numbers
  }
  return any;
}

}  // namespace pinchlab
