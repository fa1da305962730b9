// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/adapt_spans.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/cable/held_spans.h"
#include "sim/motion/piece_line.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

bool is_between_nodes(const CableState& cable, std::size_t segment) {
  return segment > 0 && segment < cable.links.size() &&
         is_strung(cable, cable.links[segment - 1]) && is_strung(cable, cable.links[segment]);
}

int pieces_of(const CableState& cable, std::size_t segment) {
  return at(cable.finest, first_piece(cable, segment)).pieces;
}

/// From the tail of one segment to the head of the same or a later one, all of them between nodes.
Line line_between(const CableState& cable, std::size_t first, std::size_t last) {
  const auto beyond = [&cable](const Link& link) {
    return is_strung(cable, link) ? -1 : link.body;
  };
  Line line;
  line.from = &cable.links[first - 1];
  line.to = &cable.links[last];
  line.passes = {beyond(cable.links[first - 2]), beyond(cable.links[last + 1])};
  const Vec2 d = cable.segments[last].head - cable.segments[first].tail;
  line.length = d.norm();
  line.direction = line.length > 0.0 ? Vec2(d / line.length) : cable.segments[first].direction;
  line.tension = infinity;
  for (std::size_t s = first; s <= last; ++s) {
    line.tension = std::min(line.tension, cable.segments[s].tension);
    line.pieces += pieces_of(cable, s);
  }
  return line;
}

/// m, by which cable would leave such a line.
double expected_sag(const CableState& cable, std::size_t first, std::size_t last,
                    const Line& line) {
  const double most = std::max(curvature(line, cable.segments[first - 1]),
                               curvature(line, cable.segments[last + 1]));
  return most * line.length * line.length / 8.0;
}

/// Of what moves and presses a line of nodes: whether more than `times` what is allowed.
bool is_moved(const Scene& scene, const World& world, const BoxTree& near, const CableState& cable,
              const Line& line, double tolerance, double times) {
  return spread_of(world, line) > times * scene.gravity.norm() * tolerance ||
         is_near_something(scene, world, near, line, cable.half_width + tolerance, 1.0 / times);
}

bool is_to_split(const Scene& scene, const World& world, const BoxTree& near, int number,
                 std::size_t segment) {
  const CableState& cable = at(world.cables, number);
  if (!is_held(cable, segment)) return false;
  const double tolerance = at(scene.cables, number).node_tolerance;
  const Line line = line_between(cable, segment, segment);
  return !(line.tension > 0.0) || expected_sag(cable, segment, segment, line) > tolerance ||
         is_moved(scene, world, near, cable, line, tolerance, 1.0);
}

/// N, of the bend that a segment may hold on its head; on its tail the opposite.
Vec2 bend_pull(const Scene& scene, const CableState& cable, std::size_t segment) {
  if (!is_held(cable, segment)) return Vec2::Zero();
  return held_force(first_moment(cable, segment), cable.segments[segment], scene.gravity);
}

/// Of the segments on either side of a link.
bool is_to_merge(const Scene& scene, const World& world, const BoxTree& near, int number,
                 std::size_t segment) {
  const CableState& cable = at(world.cables, number);
  const std::size_t next = segment + 1;
  if (!is_between_nodes(cable, segment) || !is_between_nodes(cable, next)) return false;
  const double tolerance = at(scene.cables, number).node_tolerance;
  const double most = hysteresis * tolerance;
  const Line line = line_between(cable, segment, next);
  if (!(line.tension > 0.0)) return false;
  const Vec2 off = cable.segments[segment].head - cable.segments[segment].tail;
  const double bend = std::abs(cross(line.direction, off));
  if (bend >= most || expected_sag(cable, segment, next, line) >= most) return false;
  if (bend + held_bend(cable, segment) + held_bend(cable, next) >= most) return false;
  const int node = cable.links[segment].body;
  const double share = static_cast<double>(pieces_of(cable, segment)) / line.pieces;
  const Vec2 there = (1.0 - share) * at(world.velocity, line.from->body) +
                     share * at(world.velocity, line.to->body);
  const double mass =
      0.5 * cable.density * (material_of_span(cable, segment) + material_of_span(cable, next));
  const Vec2 pull =
      mass * scene.gravity + bend_pull(scene, cable, segment) - bend_pull(scene, cable, next);
  const double swing = swing_of(mass, at(world.velocity, node) - there, pull, line,
                                cable.segments[segment], cable.segments[next]);
  if (swing >= most * scene.gravity.norm()) return false;
  return !is_moved(scene, world, near, cable, line, tolerance, hysteresis) &&
         !is_in_contact(world, node);
}

}  // namespace

bool wants_other_nodes(const Scene& scene, const World& world, const BoxTree& near, int number) {
  const CableState& cable = at(world.cables, number);
  for (std::size_t s = 1; s < cable.segments.size(); ++s) {
    if (is_to_split(scene, world, near, number, s) || is_to_merge(scene, world, near, number, s))
      return true;
  }
  return false;
}

namespace {

/// Whether of two links the first is the nearer to its end of the cable, in the finest pieces; of
/// two equally near, whether the cable bends less there. What is no node holds nothing up.
bool is_nearer_end(const CableState& cable, int first, int last) {
  const Link &one = at(cable.links, first), &other = at(cable.links, last);
  if (!is_strung(cable, one)) return true;
  if (!is_strung(cable, other)) return false;
  const int before = one.body - cable.first_node + 1;
  const int after = cable.nodes - (other.body - cable.first_node);
  if (before != after) return before < after;
  const auto bend = [&cable](int link) {
    return std::abs(
        cross(at(cable.segments, link).direction, at(cable.segments, link + 1).direction));
  };
  return bend(first) <= bend(last);
}

/// Makes two of a segment; three of an odd number of the finest, one of these in the middle, so
/// that it is the same from either end. How many nodes have come.
int split(World& world, CableState& cable, std::size_t segment) {
  const int pieces = pieces_of(cable, segment), half = pieces / 2;
  split_span(world, cable, segment, half);
  if (pieces % 2 == 0) return 1;
  split_span(world, cable, segment + 1, 1);
  return 2;
}

/// Splits what is to be split, from both ends of the cable inwards, since what one is made of
/// counts for the next: so it does not matter which end is the first. How many nodes have come.
int split_spans(const Scene& scene, World& world, const BoxTree& near, int number) {
  CableState& cable = at(world.cables, number);
  int changes = 0;
  int first = 1, last = static_cast<int>(cable.segments.size()) - 1;
  while (first <= last) {
    const bool at_first = is_nearer_end(cable, first - 1, last);
    const std::size_t segment = index(at_first ? first : last);
    if (is_to_split(scene, world, near, number, segment)) {
      const int come = split(world, cable, segment);
      changes += come;
      last += come;
    } else {
      at_first ? ++first : --last;
    }
  }
  return changes;
}

/// The same of nodes that go: one of every two at most, so that pieces grow alike. How many have.
int merge_spans(const Scene& scene, World& world, const BoxTree& near, int number) {
  CableState& cable = at(world.cables, number);
  int changes = 0;
  int first = 1, last = static_cast<int>(cable.segments.size()) - 2;
  while (first <= last) {
    const bool at_first = is_nearer_end(cable, first, last);
    const int link = at_first ? first : last;
    const bool goes = is_to_merge(scene, world, near, number, index(link));
    if (goes) {
      merge_at_node(world, cable, link);
      ++changes;
      --last;
    }
    at_first ? ++first : --last;
  }
  return changes;
}

}  // namespace

int change_nodes(const Scene& scene, World& world, const BoxTree& near, int number) {
  const int split = split_spans(scene, world, near, number);
  // What has just become two is not to become one: both limits are apart.
  return split + merge_spans(scene, world, near, number);
}

void let_out_spans(const Scene& scene, World& world, int number) {
  CableState& cable = at(world.cables, number);
  for (std::size_t s = 1; s < cable.segments.size(); ++s) {
    if (!is_held(cable, s)) continue;
    FinestPiece& span = at(cable.finest, first_piece(cable, s));
    const double wanted = wanted_share(scene, cable.segments[s], span.spare, span.held);
    const double c = cable.segments[s].rest_length;
    const double share = share_let_out(scene, world.step_length, wanted, c, span.let_out);
    if (share < 1.0) straighten(world, cable, s, share);
  }
}

}  // namespace pinchlab
