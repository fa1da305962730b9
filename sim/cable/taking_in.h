// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How rims take in the nodes of a cable with mass that runs over bodies (strung.h).
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
// and it is taken in at once. Where the cable comes back to a disc beyond a node it is a link there
// too, and the node is drawn on to the disc between the two. One that lies on a polygon's side, on
// layers or on a rim that holds it is taken in as it lies there (take_in_enclosed_nodes), and the
// slack that is left is pulled tight.
//     Cast off. Where the rim turns back instead, and has given off l / 100 since it took hold, or
// the bend has grown by half a radian, the node is a body of its own again, at its place and with
// its velocity; likewise where the cable comes off the rim. It swings out by what it was held back:
// on so short a way with next to no energy.

#include "sim/world.h"

namespace pinchlab {

/// m of cable to a rim, at which that takes hold of a node: a hundredth of l. Of one in layers its
/// half width at least: a drum's radius grows by w / pi dphi as the span beside it turns by dphi
/// (cable.h), which turns that by w / (pi d) dphi again, and must be well below 1. Of one that
/// creeps a tenth: what a rim takes of a span is extrapolated from its strain (creep.h), which errs
/// by as much over d.
double mooring_distance(const CableState& cable);

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

}  // namespace pinchlab
