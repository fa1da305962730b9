// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Spans of a cable with mass that runs over bodies which hold nodes with the bend that they had, as
// rigid bodies: held.h has how.
//
// Such a span goes from node to node (strung.h), so that the same material is on it as long as it
// is there. Beside rims pieces are the finest: these take nodes in and give them off as ever, and a
// node is freed from what a span holds before a rim has the one before it. Its n finest pieces have
// the mass rho n l, of which half moves with either end as with any other span (mass.h), and c as
// rest length. It is a rod, and bears a push until the step's end, at which it becomes two
// (motion/adapt_spans.h).

#include "base/at.h"
#include "sim/cable/strung.h"
#include "sim/world.h"

namespace pinchlab {

/// The finest piece that begins with a segment whose tail is a node of a cable that adapts.
inline int first_piece(const CableState& cable, std::size_t segment) {
  return cable.links[segment - 1].body - cable.first_node + 1;
}

/// Whether a segment holds nodes. Those of cables without mass do not, as a line of the cache tells
/// that every step reads.
inline bool is_held(const CableState& cable, std::size_t segment) {
  if (cable.density == 0.0) return false;
  if (cable.finest.empty() || segment == 0 || !is_strung(cable, cable.links[segment - 1]))
    return false;
  return at(cable.finest, first_piece(cable, segment)).pieces > 1;
}

/// What it holds.
inline const FinestPiece& held_at(const CableState& cable, std::size_t segment) {
  return at(cable.finest, first_piece(cable, segment));
}

/// m of material in any segment.
inline double material_of_span(const CableState& cable, std::size_t segment) {
  const double rest = cable.segments[segment].rest_length;
  return is_held(cable, segment) ? rest + held_at(cable, segment).spare : rest;
}

/// h in the plane (kg m), of a segment that holds nodes.
Vec2 first_moment(const CableState& cable, std::size_t segment);

/// Place of node number i, from 1 on, of those that a segment holds (m).
Vec2 place_of_held(const CableState& cable, std::size_t segment, int i);

/// m, by which a segment is bent at most.
double held_bend(const CableState& cable, std::size_t segment);

/// Makes one segment of those on either side of the node at a link, which are both between nodes.
/// Half of what the node bears of either goes to the end of the other, with its momentum.
void merge_at_node(World& world, CableState& cable, int link);

/// Frees a node, with `count` of the finest pieces before it, of those that a segment holds. It
/// moves as its place between the ends does.
void split_span(World& world, CableState& cable, std::size_t segment, int count);

/// Straightens the bend that a segment holds to that share of it (0..1).
void straighten(const World& world, CableState& cable, std::size_t segment, double share);

/// Leaves no bend in a segment that a body comes upon: what that has taken of its length is slack.
void let_go(const World& world, CableState& cable, std::size_t segment);

}  // namespace pinchlab
