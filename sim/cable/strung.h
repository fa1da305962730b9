// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Nodes that are strung on a cable with mass which runs over bodies, so that it hangs between them.
//
// Between two bodies such a cable is a chain of straight spans from node to node, each of them a
// span with mass like any other (mass.h): half of its mass moves with either end. A node is a link
// of its cable, of radius 0, on a body of its own that has no mass but the cable's. It is a place
// of the material, l = (length of the cable) / (nodes + 1) after the one before, and stays there.
// Where that place comes to lie on a rim, the rim takes the node in; where the rim gives the
// material off again, the node comes back.
//
// How a rim takes a node in: taking_in.h.
//     Given off. Where a rim has given off l / 4 beyond a node's place, and twice what it takes
// hold at, it comes back there, on a straight span, where halves of spans' masses at either end
// have the weight that they have with it. It moves as its place of the span did: momentum is kept,
// energy lost, none is made.

#include "sim/world.h"

namespace pinchlab {

/// Whether a link is a node of its cable.
inline bool is_strung(const CableState& cable, const Link& link) {
  return link.body >= cable.first_node && link.body < cable.first_node + cable.nodes;
}

/// m of material between two nodes.
double node_spacing(const CableState& cable);

/// The body that a link's node is while no rim holds it.
int node_of(const CableState& cable, const Link& link);

/// Makes a node a body that moves by itself, from there (m) with that velocity (m/s); or one that
/// lies on a rim, or is moored there, and moves with it.
void free_node(World& world, int node, const Vec2& position, const Vec2& velocity);
void lay_down_node(World& world, int node);

/// Puts on spans the nodes whose places are at least `margin` (m of material) away from their ends.
void string_all(World& world, CableState& cable, double margin);

/// Strings a cable's nodes on its spans as the cable lies at the start, and hangs those that have
/// slack as they hang at rest (hanging.h); in string_nodes.cpp.
void string_nodes(World& world, CableState& cable, const Vec2& gravity);

/// Inserts a node into a segment between two others, there (m) and with that velocity (m/s).
void insert_node(World& world, CableState& cable, std::size_t segment, int node,
                 const Vec2& position, const Vec2& velocity);

/// Whether rims have given off nodes; and puts these back.
bool has_given_off(const World& world, const CableState& cable);
void give_off_nodes(World& world, CableState& cable);

/// Makes bodies of the nodes that are links of the cable by themselves, and none of the others:
/// where an earlier state of the cable has been put back.
void sort_nodes(World& world, const CableState& cable);

/// Velocities (m/s) of the nodes that spans hold, for those of the spans' ends among `velocity`.
void carry_velocities(const World& world, const CableState& cable, std::vector<Vec2>& velocity);

/// Places the nodes that have been taken in where their material is, on rims, for tables and
/// pictures: nothing else asks where they are.
void carry_wound_nodes(World& world, const CableState& cable);

/// Whether the body holds an end of the cable further in than on its rim. A rope that hangs does
/// not meet that body, but is in front of it: what a rim took in there would be wound on the end.
bool holds_end_inside(const World& world, const CableState& cable, int body);

/// Whether it does, or a node has no more cable to an end that the body holds, other than at its
/// rim, than the body reaches. Neither it nor the spans beside it touch that body.
bool is_within_end(const World& world, const CableState& cable, const Link& node, int body);

/// Whether it is beside a disc along its cable, which is a tangent of it then, or within such an
/// end. They do not touch. A polygon's next side it may touch.
bool lies_beside(const World& world, int node, int body);

/// omega^2 of waves.h (1/s^2), at most: of a node with its neighbours, under the tensions beside
/// it, and of the turning of its spans that end on rims.
double wave_at_node(const World& world, const CableState& cable, int link);

}  // namespace pinchlab
