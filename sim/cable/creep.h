// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Elastic creep: what a rim carries over has the strain that it came on with. Of a cable that is stretched
// by e, a rim that turns by ds takes ds / (1 + e) of material, and gives back what it has taken, whatever the
// tension is where it goes off: the belt on a driven pulley is slower than on the one that drives it,
//     w1 R1 / (w2 R2) = (1 + T1 / EA) / (1 + T2 / EA).
// On discs that a cable does not slip on; elsewhere rims carry as much as they turn.

#include "sim/world.h"

namespace pinchlab {

/// Gives a link, newly on its body, a rim that carries what it turns by so far, if it is one that may
/// do otherwise.
void begin_to_carry(const World& world, CableState& cable, std::size_t link);

/// Ends an interval: what has come on to rims keeps the strain that it came on with, and what has gone off
/// them is forgotten; and sets what will come on in the next.
void lay_down(const World& world, CableState& cable);

/// m/s, by which a link's rim takes less material from the segment before it (or after it, `at_head`), or gives
/// it less, than it turns by at the world's velocities; forward positive.
double creep_speed(const World& world, const Link& link, bool at_head);

/// m of material on a link, which has wraps.
double wrapped_material(const World& world, const CableState& cable, std::size_t link);

/// J, of the strain of what a cable's rims carry; `stiffness` (N) is finite.
double energy_carried(const World& world, const CableState& cable, double stiffness);

}  // namespace pinchlab
