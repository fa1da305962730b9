// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/adapt_nodes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/motion/adapt_spans.h"
#include "sim/motion/piece_line.h"
#include "sim/pieces.h"
#include "sim/tangent.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

const CableState& piece(const World& world, const NodeChain& chain, int first) {
  return at(world.cables, piece_of(chain, first));
}

/// Where the piece before the one that begins at `first` begins, which is not the chain's first.
int before(const World& world, const NodeChain& chain, int first) {
  int number = first - 1;
  while (is_dormant(piece(world, chain, number))) --number;
  return number;
}

Line line_of(const CableState& cable) {
  const Segment& s = cable.segments[1];
  return {&cable.links[0], &cable.links[1], {cable.links[0].body, cable.links[1].body},
          s.direction,     s.length,        s.tension,
          cable.pieces};
}

Line joined(const World& world, const CableState& first, const CableState& second) {
  const Vec2 d = link_centre(world, second.links[1]) - link_centre(world, first.links[0]);
  const double length = d.norm();
  return {&first.links[0],
          &second.links[1],
          {first.links[0].body, second.links[1].body},
          length > 0.0 ? Vec2(d / length) : first.segments[1].direction,
          length,
          std::min(first.segments[1].tension, second.segments[1].tension),
          first.pieces + second.pieces};
}

/// m, by which cable between the line's ends would leave it; the line begins at the chain's piece
/// `first`.
double expected_sag(const Scene& scene, const World& world, const NodeChain& chain, int first,
                    const Line& line) {
  const double square = line.length * line.length;
  const int next = first + line.pieces;
  if (first == 0 && next == chain.pieces) {
    const double across = chain.mass_per_metre * std::abs(cross(line.direction, scene.gravity));
    if (across == 0.0) return 0.0;
    return line.tension > 0.0 ? across * square / (8.0 * line.tension) : infinity;
  }
  double most = 0.0;
  if (first > 0)
    most = curvature(line, piece(world, chain, before(world, chain, first)).segments[1]);
  if (next < chain.pieces)
    most = std::max(most, curvature(line, piece(world, chain, next).segments[1]));
  return most * square / 8.0;
}

/// m, by which the chain may be off its pieces' lines, with its width.
double off_line(const World& world, const NodeChain& chain) {
  return at(world.cables, chain.cable).half_width + chain.tolerance;
}

bool is_to_split(const Scene& scene, const World& world, const BoxTree& near,
                 const NodeChain& chain, int first) {
  const CableState& cable = piece(world, chain, first);
  if (cable.pieces < 2) return false;
  const Line line = line_of(cable);
  const double g = scene.gravity.norm();
  if (line.tension < -g * chain.mass_per_metre * chain.piece_length * line.pieces) return true;
  if (spread_of(world, line) > g * chain.tolerance) return true;
  return expected_sag(scene, world, chain, first, line) > chain.tolerance ||
         is_near_something(scene, world, near, line, off_line(world, chain), 1.0);
}

/// Of the piece that begins at `first` and the next, as large, with which it may become one.
bool is_to_merge(const Scene& scene, const World& world, const BoxTree& near,
                 const NodeChain& chain, int first) {
  const CableState& one = piece(world, chain, first);
  const int count = one.pieces;
  if (first % (2 * count) != 0 || first + 2 * count > chain.pieces) return false;
  const CableState& two = piece(world, chain, first + count);
  if (two.pieces != count) return false;
  const Line line = joined(world, one, two);
  if (!(line.tension >= 0.0)) return false;
  // Between ends that stand a straight line has the wrong length.
  if (line.pieces == chain.pieces && !moves(world, *line.from) && !moves(world, *line.to))
    return false;
  const int node = node_before(chain, first + count);
  const double most = hysteresis * chain.tolerance;
  const Vec2 off = at(world.position, node) - link_centre(world, *line.from);
  const double bend = std::abs(cross(line.direction, off));
  if (bend >= most || expected_sag(scene, world, chain, first, line) >= most) return false;
  const Vec2 middle = 0.5 * (end_velocity(world, *line.from) + end_velocity(world, *line.to));
  const double mass = at(world.bodies, node).mass;
  const Vec2 pull = mass * scene.gravity +
                    held_force(first_moment(one), one.segments[1], scene.gravity) -
                    held_force(first_moment(two), two.segments[1], scene.gravity);
  const double lost =
      spread_of(world, line) + swing_of(mass, at(world.velocity, node) - middle, pull, line,
                                        one.segments[1], two.segments[1]);
  if (lost >= scene.gravity.norm() * most) return false;
  if (bend + held_bend(world, chain, first) + held_bend(world, chain, first + count) >= most)
    return false;
  return !is_in_contact(world, node) &&
         !is_near_something(scene, world, near, line, off_line(world, chain), 1.0 / hysteresis);
}

/// Hands mass (kg) of the velocity v to what holds an end, or with mass < 0 takes it from there.
void hand_over(World& world, const Link& end, double mass, const Vec2& v) {
  if (!moves(world, end)) return;
  BodyProperties& body = at(world.bodies, end.body);
  Vec2& velocity = at(world.velocity, end.body);
  Vec2 change = mass / (body.mass + mass) * (v - velocity);
  if (body.kind == BodyKind::rail) change = body.rail_axis * body.rail_axis.dot(change);
  velocity += change;
  body.mass += mass;
}

void turn_all(World& world, const NodeChain& chain, int first, const Vec2& to) {
  const CableState& cable = piece(world, chain, first);
  const Vec2& from = cable.segments[1].direction;
  const double angle = std::atan2(cross(to, from), to.dot(from));
  for (int i = 0; i < cable.pieces; ++i)
    at(world.cables, piece_of(chain, first + i)).turned += angle;
}

/// A piece has other ends.
void settle_piece(World& world, const NodeChain& chain, int first) {
  settle_held(world, chain, first);
  CableState& cable = at(world.cables, piece_of(chain, first));
  count_changes(world, cable, 1);
  update_cable(world, cable, true, false);
  cable.segments[1].slack = false;
  cable.let_out = 0.0;
}

void merge(World& world, const NodeChain& chain, int first) {
  CableState& one = at(world.cables, piece_of(chain, first));
  const int second = first + one.pieces, node = node_before(chain, second);
  CableState& two = at(world.cables, piece_of(chain, second));
  const Line line = joined(world, one, two);
  const double half = 0.5 * at(world.bodies, node).mass;
  hand_over(world, *line.from, half, at(world.velocity, node));
  hand_over(world, *line.to, half, at(world.velocity, node));
  turn_all(world, chain, first, line.direction);
  turn_all(world, chain, second, line.direction);
  std::swap(one.links[1], two.links[1]);
  one.pieces = line.pieces;
  two.pieces = 0;
  BodyProperties& body = at(world.bodies, node);
  body.kind = BodyKind::fixed;
  body.outlined = false;
  settle_piece(world, chain, first);
}

void split(World& world, const NodeChain& chain, int first) {
  CableState& one = at(world.cables, piece_of(chain, first));
  const Line line = line_of(one);
  const int half = one.pieces / 2, second = first + half, node = node_before(chain, second);
  CableState& two = at(world.cables, piece_of(chain, second));
  BodyProperties& body = at(world.bodies, node);
  const Vec2 seat = body.seat.x() * line.direction + body.seat.y() * left(line.direction);
  at(world.position, node) = link_centre(world, *line.from) + seat;
  const Vec2 from = end_velocity(world, *line.from), to = end_velocity(world, *line.to);
  at(world.velocity, node) = 0.5 * (from + to);
  at(world.angular_velocity, node) = 0.0;
  at(world.still_steps, node) = 0;
  body.kind = BodyKind::free;
  body.outlined = true;
  body.mass = chain.mass_per_metre * chain.piece_length * half;
  hand_over(world, *line.from, -0.5 * body.mass, from);
  hand_over(world, *line.to, -0.5 * body.mass, to);
  std::swap(one.links[1], two.links[1]);
  one.pieces = two.pieces = half;
  settle_piece(world, chain, first);
  settle_piece(world, chain, second);
  two.segments[1].tension = one.segments[1].tension;
}

bool is_still(const NodeChain& chain, const Workspace& work) {
  return is_idle(work.parts, index(chain.cable));
}

/// Whether nodes of a cable that runs over bodies may come and go now.
bool adapts(const World& world, const Workspace& work, int cable) {
  return !at(world.cables, cable).finest.empty() && !is_idle(work.parts, index(cable));
}

bool any_adapts(const Scene& scene, const World& world, const Workspace& work) {
  return std::ranges::any_of(scene.chains,
                             [&](const NodeChain& chain) { return !is_still(chain, work); }) ||
         std::ranges::any_of(world.strung, [&](int c) { return adapts(world, work, c); });
}

/// Lets out the bend of a piece towards where half of its tension would have it.
void let_out(const Scene& scene, World& world, const NodeChain& chain, int first) {
  CableState& cable = at(world.cables, piece_of(chain, first));
  const double spare = cable.pieces * chain.piece_length - cable.length;
  const double wanted = wanted_share(scene, cable.segments[1], spare, cable.held);
  const double share = share_let_out(scene, world.step_length, wanted, cable.length, cable.let_out);
  if (share == 1.0) return;
  for (int i = 0; i < cable.pieces; ++i) {
    at(world.cables, piece_of(chain, first + i)).turned *= share;
  }
  settle_held(world, chain, first);
  update_cable(world, cable, false, false);
}

}  // namespace

bool wants_other_nodes(const Scene& scene, const World& world, Workspace& work) {
  if (!any_adapts(scene, world, work)) return false;
  find_surroundings(scene, world, work.surroundings);
  const BoxTree& near = work.surroundings;
  for (const NodeChain& chain : scene.chains) {
    if (is_still(chain, work)) continue;
    for (int first = 0; first < chain.pieces; first += piece(world, chain, first).pieces) {
      if (is_to_split(scene, world, near, chain, first) ||
          is_to_merge(scene, world, near, chain, first))
        return true;
    }
  }
  return std::ranges::any_of(world.strung, [&](int c) {
    return adapts(world, work, c) && wants_other_nodes(scene, world, near, c);
  });
}

void change_nodes(const Scene& scene, World& world, Workspace& work) {
  // What others gain in speed by taking nodes over is allowed for in the next step.
  find_surroundings(scene, world, work.surroundings);
  const BoxTree& near = work.surroundings;
  for (const NodeChain& chain : scene.chains) {
    if (is_still(chain, work)) continue;
    for (int first = 0; first < chain.pieces;) {
      if (is_to_split(scene, world, near, chain, first)) {
        split(world, chain, first);
        ++world.diagnostics.node_changes;
      } else {
        first += piece(world, chain, first).pieces;
      }
    }
    // What has just become two is not to become one: both limits are apart.
    for (int first = 0; first < chain.pieces; first += piece(world, chain, first).pieces) {
      if (!is_to_merge(scene, world, near, chain, first)) continue;
      merge(world, chain, first);
      ++world.diagnostics.node_changes;
    }
  }
  for (const int c : world.strung) {
    if (adapts(world, work, c))
      world.diagnostics.node_changes += change_nodes(scene, world, near, c);
  }
  if (!world.pieces_at.empty()) join_pieces(scene, world);
  work.broad_phase.boxes.clear();  // for bodies with other outlines
}

void follow_chains(const Scene& scene, World& world, const Workspace& work) {
  for (const NodeChain& chain : scene.chains) {
    if (is_still(chain, work)) continue;
    for (int first = 0; first < chain.pieces; first += piece(world, chain, first).pieces) {
      if (piece(world, chain, first).pieces > 1) let_out(scene, world, chain, first);
    }
    carry_held(world, chain);
  }
  for (const int c : world.strung) {
    if (adapts(world, work, c)) let_out_spans(scene, world, c);
  }
}

}  // namespace pinchlab
