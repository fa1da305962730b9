// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/adapt_nodes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/compound.h"
#include "sim/lines.h"
#include "sim/pieces.h"
#include "sim/tangent.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

// Of what makes one piece two, what lets two be one: so that nothing comes and goes at one border,
// though two pieces show somewhat less of a curve than one would.
constexpr double hysteresis = 0.5;

/// A straight line between two ends: of a piece, or of what two would become.
struct Line {
  Link from, to;
  Vec2 direction = Vec2::Zero();
  double length = 0.0;   // m
  double tension = 0.0;  // N, of the last step
  int pieces = 0;        // of the finest
};

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
  return {cable.links[0], cable.links[1], s.direction, s.length, s.tension, cable.pieces};
}

Line joined(const World& world, const CableState& first, const CableState& second) {
  const Vec2 d = link_centre(world, second.links[1]) - link_centre(world, first.links[0]);
  const double length = d.norm();
  return {first.links[0],
          second.links[1],
          length > 0.0 ? Vec2(d / length) : first.segments[1].direction,
          length,
          std::min(first.segments[1].tension, second.segments[1].tension),
          first.pieces + second.pieces};
}

double curvature(const Line& line, const CableState& other) {
  const Segment& s = other.segments[1];
  const double angle =
      std::atan2(std::abs(cross(line.direction, s.direction)), line.direction.dot(s.direction));
  return 2.0 * angle / (line.length + s.length);
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
  if (first > 0) most = curvature(line, piece(world, chain, before(world, chain, first)));
  if (next < chain.pieces) most = std::max(most, curvature(line, piece(world, chain, next)));
  return most * square / 8.0;
}

/// Whether the body holds an end of the line, or is a shape of what does.
bool holds_line(const World& world, const Line& line, int body) {
  const int mover = mover_of(world, body);
  return line.from.body == body || line.from.body == mover || line.to.body == body ||
         line.to.body == mover;
}

/// Whether a body or wall is no further from the line than `times` what both may move in two steps,
/// with what the cable may be off it.
bool is_near_something(const Scene& scene, const World& world, const NodeChain& chain,
                       const Line& line, double times) {
  const Vec2 start = link_centre(world, line.from);
  const Vec2 end = link_centre(world, line.to);
  const double h = world.step_length;
  const double speed =
      std::max(end_velocity(world, line.from).norm(), end_velocity(world, line.to).norm()) +
      h * scene.gravity.norm();
  const double own = at(world.cables, chain.cable).half_width + chain.tolerance + 2.0 * h * speed;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const BodyProperties& body = world.bodies[b];
    if (body.node || !body.outlined || holds_line(world, line, static_cast<int>(b))) continue;
    const double reach = own + 2.0 * h * (world.velocity[b].norm() + h * scene.gravity.norm());
    if (distance_from_line(start, end, world.position[b]) < body.radius + times * reach)
      return true;
  }
  return std::any_of(scene.walls.begin(), scene.walls.end(), [&](const Wall& wall) {
    return distance_between_lines(start, end, wall.a, wall.b) < times * own;
  });
}

/// J/kg, |v_b - v_a|^2 / 8.
double spread_of(const World& world, const Line& line) {
  return 0.125 * (end_velocity(world, line.to) - end_velocity(world, line.from)).squaredNorm();
}

bool is_to_split(const Scene& scene, const World& world, const NodeChain& chain, int first) {
  const CableState& cable = piece(world, chain, first);
  if (cable.pieces < 2) return false;
  const Line line = line_of(cable);
  const double g = scene.gravity.norm();
  if (line.tension < -g * chain.mass_per_metre * chain.piece_length * line.pieces) return true;
  if (spread_of(world, line) > g * chain.tolerance) return true;
  return expected_sag(scene, world, chain, first, line) > chain.tolerance ||
         is_near_something(scene, world, chain, line, 1.0);
}

bool is_in_contact(const World& world, int body) {
  return std::any_of(world.contacts.begin(), world.contacts.end(), [body](const Contact& contact) {
    return contact.a == body || contact.b == body;
  });
}

/// Of the piece that begins at `first` and the next, as large, with which it may become one.
bool is_to_merge(const Scene& scene, const World& world, const NodeChain& chain, int first) {
  const CableState& one = piece(world, chain, first);
  const int count = one.pieces;
  if (first % (2 * count) != 0 || first + 2 * count > chain.pieces) return false;
  const CableState& two = piece(world, chain, first + count);
  if (two.pieces != count) return false;
  const Line line = joined(world, one, two);
  if (!(line.tension >= 0.0)) return false;
  // Between ends that stand a straight line has the wrong length.
  if (line.pieces == chain.pieces && !moves(world, line.from) && !moves(world, line.to))
    return false;
  const int node = node_before(chain, first + count);
  const double most = hysteresis * chain.tolerance;
  const Vec2 off = at(world.position, node) - link_centre(world, line.from);
  const double bend = std::abs(cross(line.direction, off));
  if (bend >= most || expected_sag(scene, world, chain, first, line) >= most) return false;
  const Vec2 middle = 0.5 * (end_velocity(world, line.from) + end_velocity(world, line.to));
  const double lost =
      spread_of(world, line) + 0.5 * (at(world.velocity, node) - middle).squaredNorm();
  if (lost >= scene.gravity.norm() * most) return false;
  if (bend + held_bend(world, chain, first) + held_bend(world, chain, first + count) >= most)
    return false;
  return !is_in_contact(world, node) &&
         !is_near_something(scene, world, chain, line, 1.0 / hysteresis);
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
  hand_over(world, line.from, half, at(world.velocity, node));
  hand_over(world, line.to, half, at(world.velocity, node));
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
  at(world.position, node) = link_centre(world, line.from) + seat;
  const Vec2 from = end_velocity(world, line.from), to = end_velocity(world, line.to);
  at(world.velocity, node) = 0.5 * (from + to);
  at(world.angular_velocity, node) = 0.0;
  at(world.still_steps, node) = 0;
  body.kind = BodyKind::free;
  body.outlined = true;
  body.mass = chain.mass_per_metre * chain.piece_length * half;
  hand_over(world, line.from, -0.5 * body.mass, from);
  hand_over(world, line.to, -0.5 * body.mass, to);
  std::swap(one.links[1], two.links[1]);
  one.pieces = two.pieces = half;
  settle_piece(world, chain, first);
  settle_piece(world, chain, second);
  two.segments[1].tension = one.segments[1].tension;
}

bool is_still(const NodeChain& chain, const Workspace& work) {
  return is_idle(work.parts, index(chain.cable));
}

/// Lets out the bend of a piece towards where half of its tension would have it.
void let_out(const Scene& scene, World& world, const NodeChain& chain, int first) {
  // A share that is to be left: nothing changes. A bend is within the tolerance, and a thousandth
  // of that does not show; so a cable at rest hangs as it hung.
  constexpr double enough = 0.999;
  CableState& cable = at(world.cables, piece_of(chain, first));
  const Segment& segment = cable.segments[1];
  const double spare = cable.pieces * chain.piece_length - cable.length;
  const double across = cable.held.y() * scene.gravity.dot(left(segment.direction));
  const bool pulls = segment.tension > 0.0 && spare > 0.0;
  const double left_over = pulls ? std::max(across / (segment.tension * spare), 0.0) : infinity;
  if (left_over >= enough) {
    cable.let_out = 0.0;
    return;
  }
  const double h = world.step_length, rate = std::sqrt(scene.gravity.norm() / cable.length);
  cable.let_out += h * rate * (rate * (1.0 - left_over) - 2.0 * cable.let_out);
  const double share = std::max(1.0 - h * cable.let_out, left_over);
  for (int i = 0; i < cable.pieces; ++i) {
    at(world.cables, piece_of(chain, first + i)).turned *= share;
  }
  settle_held(world, chain, first);
  update_cable(world, cable, false, false);
}

}  // namespace

bool wants_other_nodes(const Scene& scene, const World& world, const Workspace& work) {
  for (const NodeChain& chain : scene.chains) {
    if (is_still(chain, work)) continue;
    for (int first = 0; first < chain.pieces; first += piece(world, chain, first).pieces) {
      if (is_to_split(scene, world, chain, first) || is_to_merge(scene, world, chain, first))
        return true;
    }
  }
  return false;
}

void change_nodes(const Scene& scene, World& world, Workspace& work) {
  for (const NodeChain& chain : scene.chains) {
    if (is_still(chain, work)) continue;
    for (int first = 0; first < chain.pieces;) {
      if (is_to_split(scene, world, chain, first)) {
        split(world, chain, first);
        ++world.diagnostics.node_changes;
      } else {
        first += piece(world, chain, first).pieces;
      }
    }
    // What has just become two is not to become one: both limits are apart.
    for (int first = 0; first < chain.pieces; first += piece(world, chain, first).pieces) {
      if (!is_to_merge(scene, world, chain, first)) continue;
      merge(world, chain, first);
      ++world.diagnostics.node_changes;
    }
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
}

}  // namespace pinchlab
