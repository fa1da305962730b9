// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Waves on hanging cables of nodes, which intervals must follow.
//
// Under the tension T nodes of mass m a distance l apart swing fastest where each goes against the
// next: omega^2 = 4 T / m l. By a leapfrog the energy of such a wave swings by (omega h)^2 / 4 of
// itself: v^2 + (1 - (omega h)^2 / 4) omega^2 x^2 is what it keeps (v the mean of the speeds before
// and after a kick; Hairer, Lubich & Wanner 2003, *Geometric numerical integration illustrated by
// the Stormer-Verlet method*), and from omega h = 2 on it grows without bound.
//     Nodes are chosen so that omega h is 1 at most under the tension that is to be expected
// (node_count.h). A body that lands on a cable pulls it taut in a few milliseconds: omega^2 is then
// a thousand times that, and falls again. A step in which omega h would be more than 1 is divided
// into intervals in which it is a half.
//     A node that is held instead to the line between its neighbours, as a body that is too light
// is (solve/light_bodies.h), has for the time the mass m (omega h)^2: it is stopped with a hundred
// times the momentum that it was set in motion with. So do nodes only where events are not located,
// and under tensions that would ask for more than a thousand intervals a step.

#include "sim/world.h"

namespace pinchlab {

/// omega^2 (1/s^2) of the nodes at either end of a piece, under its tension; 0 of other cables.
double wave_of(const World& world, const CableState& cable);

/// Whether a step is divided for waves of that omega^2 (1/s^2).
bool is_divided_for(const World& world, double wave);

/// Whether no interval that is tried follows them.
bool is_lost(const World& world, double wave);

/// The interval (s) to try for them, and whether one of `length` (s), whose own tensions they are
/// due to, was short enough.
double interval_for(const World& world, double wave);
bool follows(const World& world, double wave, double length);

}  // namespace pinchlab
