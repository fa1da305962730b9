// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Waves on hanging cables of nodes, which intervals must follow.
//
// Under the tension T nodes of mass m a distance l apart swing fastest where each goes against the
// next: omega^2 = 4 T / m l. By a leapfrog the energy of such a wave swings by (omega h)^2 / 4 of
// itself: v^2 + (1 - (omega h)^2 / 4) omega^2 x^2 is what it keeps (v the mean of the speeds before
// and after a kick; Hairer, Lubich & Wanner 2003, *Geometric numerical integration illustrated by
// the Stormer-Verlet method*, Acta Numerica 12), and from omega h = 2 on it grows without bound.
//     Nodes are chosen so that omega h is 1 at most under the tension that is to be expected, or
// sqrt(2) where a cable just hangs (node_count.h). A body that lands on a cable pulls it taut in a
// few milliseconds, in which omega^2 becomes a thousand times that, and falls again. So a step in
// which omega h would be more is divided into intervals in which it is a half. With a cable that
// runs over bodies it is divided from 1 on: rims take nodes in and let them go, and at sqrt(2) a
// hoist's weights are 2.5e-5 m off where they are 2e-5 m (test
// Strung.ConvergesWithStepsAndWithNodes).
//     Were a node drawn to the line between its neighbours instead, as a body that is too light is
// (solve/light_bodies.h), it would have the mass m' = m (omega h)^2 while it is stopped, and m when
// it was set in motion: energy from nothing.
//     The tension of a chain that is pulled taut by the energy E rises until its waves have all of
// that: with a of theirs at first and d to spare to T = E^2 / (2 a d), any number. What would ask
// for intervals of less than a thousandth of a step is drawn to a line at rest. With m' and the
// speed m v / m' the node has less energy than it had with m and v, and more than it has with m
// afterwards, so that none is made; but momentum is lost.
//     A span with mass that turns by a' sends mass on to the rims at its ends, R a' rho a second,
// and the force of that is found before a kick (forces.cpp): it must not turn far in an interval
// either. Beside the end of a cable short spans turn fast.
//     Nodes that are strung on a cable between what does not give (strung.h), as where something
// jams it on to a polygon, are pulled straight with any tension, and stay so. Those that are lost
// are drawn to the line between their neighbours, and intervals need not follow them.

#include "sim/world.h"

namespace pinchlab {

/// omega^2 (1/s^2) of the fastest wave on a cable, or piece of one, if a step is divided for it;
/// else 0.
double wave_of(const World& world, const CableState& cable);

/// Whether no interval that is tried follows them.
bool is_lost(const World& world, double wave);

/// Of a step, the shortest interval in which anything is followed.
constexpr double shortest_followed = 1e-3;

/// The interval (s) to try for them, and whether one of `length` (s), whose own tensions they are
/// due to, was short enough.
double interval_for(const World& world, double wave);
bool follows(const World& world, double wave, double length);

}  // namespace pinchlab
