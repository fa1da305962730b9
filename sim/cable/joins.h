// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Who joins and leaves a cable with mass: momentum goes with the mass that changes hands.

#include "sim/world.h"

namespace pinchlab {

/// insert_link and remove_link of a cable that may have mass: a body that it meets, or its sleeve
/// there, and those that it is left to, take up the momentum of their new share, which they and no
/// others bear.
void meet_body(World& world, CableState& cable, std::size_t segment, int body, int corner,
               int orientation);
void leave_body(World& world, CableState& cable, int link);

/// Moors a node to the rim at another link (taking_in.h), at its place there. What moves with the
/// rim takes up the node's momentum.
void join_rim(World& world, CableState& cable, int link, int rim);

/// remove_link of a node (strung.h). The span that closes up lies on a rim otherwise than it did:
/// each of the node's neighbours keeps the momentum that it had, and those of the node's mass that
/// it gets.
void leave_node(World& world, CableState& cable, int link);

}  // namespace pinchlab
