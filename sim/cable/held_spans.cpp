// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/held_spans.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/cable/links.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// Gives the span that begins with that piece its length, first moment and seats, from what its
/// finest are turned by.
void settle(CableState& cable, int first) {
  FinestPiece& span = at(cable.finest, first);
  const double l = node_spacing(cable);
  const auto piece = [&](int i) -> FinestPiece& { return at(cable.finest, first + i); };
  const HeldLine line = lay_held(
      span.pieces, l, [&](int i) -> double& { return piece(i).turned; },
      [&](int i) -> Vec2& { return piece(i).seat; });
  span.spare = span.pieces > 1 ? span.pieces * l - line.length : 0.0;
  span.held = cable.density * l * line.moment;
}

/// Gives a node that mass (kg) with the velocity v, beside what it has of its cable.
void join_node(World& world, const CableState& cable, int link, double mass, const Vec2& v) {
  const auto i = index(link);
  const double own =
      0.5 * cable.density * (material_of_span(cable, i) + material_of_span(cable, i + 1));
  Vec2& velocity = at(world.velocity, cable.links[i].body);
  velocity += mass / (own + mass) * (v - velocity);
}

void turn_pieces(CableState& cable, std::size_t segment, const Vec2& to) {
  const int first = first_piece(cable, segment), count = at(cable.finest, first).pieces;
  const Vec2& from = cable.segments[segment].direction;
  const double angle = std::atan2(cross(to, from), to.dot(from));
  for (int i = 0; i < count; ++i) at(cable.finest, first + i).turned += angle;
}

}  // namespace

Vec2 first_moment(const CableState& cable, std::size_t segment) {
  return along_line(cable.segments[segment].direction, held_at(cable, segment).held);
}

Vec2 place_of_held(const CableState& cable, std::size_t segment, int i) {
  const Segment& span = cable.segments[segment];
  const FinestPiece& piece = at(cable.finest, first_piece(cable, segment) + i);
  return span.tail + along_line(span.direction, piece.seat);
}

double held_bend(const CableState& cable, std::size_t segment) {
  const int first = first_piece(cable, segment), count = at(cable.finest, first).pieces;
  double bend = 0.0;
  for (int i = 1; i < count; ++i) {
    bend = std::max(bend, std::abs(at(cable.finest, first + i).seat.y()));
  }
  return bend;
}

void merge_at_node(World& world, CableState& cable, int link) {
  const auto segment = index(link), next = segment + 1;
  const int node = cable.links[segment].body;
  const int first = first_piece(cable, segment), second = first_piece(cable, next);
  const Vec2 line = cable.segments[next].head - cable.segments[segment].tail;
  const double tension = std::min(cable.segments[segment].tension, cable.segments[next].tension);
  const double half = 0.5 * cable.density * node_spacing(cable);  // kg
  const Vec2& v = at(world.velocity, node);
  join_node(world, cable, link - 1, half * at(cable.finest, second).pieces, v);
  join_node(world, cable, link + 1, half * at(cable.finest, first).pieces, v);
  turn_pieces(cable, segment, line.normalized());
  turn_pieces(cable, next, line.normalized());
  at(cable.finest, first).pieces += at(cable.finest, second).pieces;
  at(cable.finest, first).let_out = 0.0;
  at(cable.finest, second).pieces = 0;
  settle(cable, first);
  cable.links.erase(cable.links.begin() + link);
  cable.segments.erase(cable.segments.begin() + link);
  cable.segments[segment].tension = tension;
  lay_down_node(world, node);
  update_tangent(world, cable, segment);
  begin_here(cable.segments[segment]);
  cable.segments[segment].slack = false;
  count_changes(world, cable, 1);
  update_wraps_and_rest_lengths(world, cable);
}

void split_span(World& world, CableState& cable, std::size_t segment, int count) {
  const int first = first_piece(cable, segment), second = first + count;
  FinestPiece& whole = at(cable.finest, first);
  const double share = static_cast<double>(count) / whole.pieces;
  const Vec2 &from = at(world.velocity, cable.links[segment - 1].body),
             &to = at(world.velocity, cable.links[segment].body);
  const Vec2 velocity = (1.0 - share) * from + share * to;
  const Vec2 position = place_of_held(cable, segment, count);
  at(cable.finest, second).pieces = whole.pieces - count;
  whole.pieces = count;
  whole.let_out = at(cable.finest, second).let_out = 0.0;
  settle(cable, first);
  settle(cable, second);
  insert_node(world, cable, segment, cable.first_node + second - 1, position, velocity);
  cable.segments[segment].slack = cable.segments[segment + 1].slack = false;
}

void straighten(const World& world, CableState& cable, std::size_t segment, double share) {
  const int first = first_piece(cable, segment), count = at(cable.finest, first).pieces;
  for (int i = 0; i < count; ++i) at(cable.finest, first + i).turned *= share;
  settle(cable, first);
  update_wraps_and_rest_lengths(world, cable);
}

void let_go(const World& world, CableState& cable, std::size_t segment) {
  const int first = first_piece(cable, segment), count = at(cable.finest, first).pieces;
  for (int i = 0; i < count; ++i) at(cable.finest, first + i) = {};
  update_wraps_and_rest_lengths(world, cable);
}

}  // namespace pinchlab
