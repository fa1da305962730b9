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
// Moored. A node with d of cable left to a rim swings faster and faster as d falls, with
// omega^2 = T / m d under the tension T, for which intervals are divided (waves.h); over all of d
// that is 2 sqrt(T l / m) / v radians, v the speed at which it comes: no more than twice what a
// node in the middle of the cable swings by meanwhile. A node that nothing pulls may also come down
// on the rim with cable to spare. So a rim takes hold of a node where of its cable, or of the
// straight line to the rim, a hundredth of l is left: an event, like others located in time. The
// node stays where it is, on an arm that turns with the rim: its link is one on the rim's body
// (Link::moored), which takes up its momentum, and the arm is rigid, like a side of a polygon.
//     Taken in. At the arm's end the cable is bent away from the rim, at rest by W / T (W the
// node's weight). The rim turns on, until the span beyond is in line with the arm, and so a tangent
// of the rim: then the link goes. Nothing moves by that, and halves of spans' masses at their ends
// have the same weight before and after; momentum goes with the mass (joins.h), and no energy is
// made. Where a node is not bent away from the rim, the span beyond is next to a tangent already,
// and it is taken in at once. One that another body has met beyond it is taken in as it lies there
// (take_in_enclosed_nodes), and the slack that is left is pulled tight.
//     Cast off. Where the rim turns back instead, and has given off l / 100 since it took hold, or
// the bend has grown by half a radian, the node is a body of its own again, at its place and with
// its velocity; likewise where the cable comes off the rim. It swings out by what it was held back:
// on so short a way with next to no energy.
//     Given off. Where a rim has given off l / 4 beyond a node's place, it comes back there, on a
// straight span, where halves of spans' masses at either end have the weight that they have with
// it. It moves as its place of the span did: momentum is kept, energy lost, none is made.

#include "sim/world.h"

namespace pinchlab {

/// Whether a link is a node of its cable.
inline bool is_strung(const CableState& cable, const Link& link) {
  return link.body >= cable.first_node && link.body < cable.first_node + cable.nodes;
}

/// Strings a cable's nodes on its spans as the cable lies at the start, and hangs those that have
/// slack as they hang at rest (hanging.h).
void string_nodes(World& world, CableState& cable, const Vec2& gravity);

/// Whether rims have given off nodes; and puts these back.
bool has_given_off(const World& world, const CableState& cable);
void give_off_nodes(World& world, CableState& cable);

/// Makes bodies of the nodes that are links of the cable by themselves, and none of the others:
/// where an earlier state of the cable has been put back.
void sort_nodes(World& world, const CableState& cable);

/// Places the nodes that have been taken in where their material is, on rims, for tables and
/// pictures: nothing else asks where they are.
void carry_wound_nodes(World& world, const CableState& cable);

/// Whether a node has no more cable to an end that the body holds than the body reaches. Neither it
/// nor the spans beside it touch that body.
bool is_within_end(const World& world, const CableState& cable, const Link& node, int body);

/// Whether it is beside a disc along its cable, which is a tangent of it then, or within such an
/// end. They do not touch. A polygon's next side it may touch.
bool lies_beside(const World& world, int node, int body);

/// What is left between a node and a rim beside it until the rim takes hold of it (m); infinity:
/// there is none. Of a moored one, until it is taken in or cast off.
double left_until_taken_in(const World& world, const CableState& cable, int link);

/// Whether a node, not moored, of which nothing is left is to be moored; or a moored one to be cast
/// off. Else it is to be taken in.
bool is_to_be_moored(const CableState& cable, int link);
bool is_to_be_cast_off(const World& world, const CableState& cable, int link);

/// Moors a node to the rim beside it; and casts one off, which moves on as it did with the rim: a
/// body by itself again, whose number is returned.
void moor_node(World& world, CableState& cable, int link);
int cast_off_node(World& world, CableState& cable, int link);

/// Takes in the nodes between two links in succession on one body, which has met the cable beyond
/// them: they lie on it. Whether there were any.
bool take_in_enclosed_nodes(World& world, CableState& cable);

/// Takes a node in.
void take_in_node(World& world, CableState& cable, int link);

/// omega^2 of waves.h (1/s^2), at most: of a node with its neighbours, under the tensions beside
/// it, and of the turning of its spans that end on rims.
double wave_at_node(const World& world, const CableState& cable, int link);

}  // namespace pinchlab
