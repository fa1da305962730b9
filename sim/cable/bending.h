// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bending of chains of nodes: where two pieces of length l meet at the angle th, a moment
//     M = EI th / l.

#include "sim/world.h"

namespace pinchlab {

/// What bending does to the three points that two pieces join: their start, the node, their end
/// (N).
struct BendForces {
  Vec2 start, node, end;
};

/// Of a piece that bends against the next.
BendForces bend_forces(const World& world, const CableState& cable);

/// J, likewise: EI th^2 / 2 l.
double bending_energy(const World& world, const CableState& cable);

}  // namespace pinchlab
