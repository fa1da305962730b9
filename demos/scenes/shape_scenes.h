// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes of corners, layers and cables with mass, for experiments and tests.

#include <vector>

#include "sim/scene.h"

namespace pinchlab::build {

/// A regular polygon's corners, counter-clockwise, on a circle of `radius` (m) from the angle
/// `first` (rad) on.
std::vector<Vec2> regular_corners(int count, double radius, double first = 0.0);

/// A box's, m.
std::vector<Vec2> box_corners(double width, double height);

/// A bob of 1 kg whose cable comes down the right of a fixed square and round its lower corner. The
/// cable's angle th from the vertical grows as it unwinds; where it passes 0 the side comes free.
struct SquareDrum {
  double half = 0.3;         // m, of a side
  double half_width = 0.05;  // m, of the cable
  double free = 0.8;         // m, at the start
  double start = -0.6;       // rad

  Scene scene(int steps_per_frame) const;

  /// Where the bob is after so many seconds (m): l th'' + w th'^2 + g sin th = 0 by Runge and
  /// Kutta's method; where th passes 0, l grows by the side, and l th' stays.
  Vec2 bob_after(double seconds) const;

 private:
  Vec2 place(double th) const;
};

/// A bob of 1 kg on a drum with a fixed axle, of the inertia 2 kg m^2, turning by `speed` (rad/s)
/// at the start: bodies 0 (the drum, whose cable starts on its left) and 1.
Scene turning_drum(const std::vector<Vec2>& corners, double speed, int steps_per_frame);
Scene turning_drum(double radius, double speed, int steps_per_frame);

/// A disc of 1 kg, body 1, at rest on a plank that turns about its middle, body 0; neither slips.
Scene disc_on_plank(int steps_per_frame);

/// A box of 2 kg, body 1, that rocks on a fixed disc, body 0, from where it leans by 0.4 rad on;
/// neither slips.
Scene box_on_disc(int steps_per_frame);

/// A weight of 5 kg, body 1, and another on a cable over a drum of six corners, on which it may
/// slip; a roller on a rail falls on to it there and presses it.
Scene pressed_drum(int steps_per_frame);

/// A load of 2 kg, body 1, on a rail below a drum of 0.2 m with so many turns in layers. The cable
/// begins on the drum, or ends there.
Scene layered_hoist(int turns, double half_width, int steps_per_frame, bool begins_there = true);

/// The same of 8 turns with a rope of 2 kg/m, on which 20 kg swing beside the drum.
Scene heavy_hoist(int steps_per_frame, bool begins_there = true);

constexpr double belt_stiffness = 1e4;    // N, EA, of belt_drive
constexpr double belt_half_width = 0.01;  // m

/// A belt on two pulleys 1 m apart, stretched by `tension` (N) all over once it has gone round.
/// Body 0, of 0.2 m, is driven at 6 rad/s; drag on body 1, of `radius` (m), asks for `difference`
/// (N) between its spans.
Scene belt_drive(double radius, double tension, double difference, int steps_per_frame);

/// Atwood's machine with a heavy rope, of 4 m and 0.4 kg/m in all: weights of 1 and 1.5 kg, bodies
/// 0 and 1, hang level over a pulley with I / R^2 = 0.25 kg. From rest the heavier one falls by
///     x = 0.625 m (cosh k t - 1),   k^2 = 0.8 kg/m g / 4.35 kg.
Scene rope_atwood(int steps_per_frame);

/// A rope of 1.6 kg that slips on a standing peg, 0.2 m longer on the right, with 0.1 kg at either
/// end; with cable friction `mu` between it and the peg.
Scene rope_over_peg(double mu, int steps_per_frame);

/// A block, body 0, in the bight of a rope of 0.8 kg/m, which runs on over a pulley to a weight,
/// body 1. From rest both swing.
Scene heavy_tackle(int steps_per_frame);

/// Weights of 6 and 7 kg, bodies 0 and 1, on a rope of 1.5 kg/m over two pulleys, between which it
/// sags. From rest the heavier one falls. Without nodes the rope is straight.
Scene sagging_hoist(int nodes, int steps_per_frame);

/// A cable of 2 m and 1 kg/m whose ends are 1 m apart at one height, in so many pieces (0: as the
/// program chooses). Before spread_nodes.
Scene catenary(int pieces, int steps_per_frame);

/// The flexible pendulum of Westin and Irani: 1 m long, 0.39269908 kg/m, EA = 1570.7963 N, EI = 0.2
/// N m^2, pinned at the origin and let go horizontally, in so many pieces. Body 0 is its tip. After
/// spread_nodes.
Scene flexible_pendulum(int pieces, int steps_per_frame);

/// A chain of 1 m and 1 kg in so many pieces, hung up by both ends beside one another, one of
/// which, body 0, is let go. With a tolerance (m) its number of nodes adapts, and the end has its
/// half piece itself. After spread_nodes.
Scene folded_chain(int pieces, int steps_per_frame, double tolerance = 0.0);

/// A cable of 1.25 m and 0.8 kg/m hangs between a post and a ring, body 0, which a winch's rope
/// pulls until the cable is straight, at 2 kN, and lets down again, in 5 s. So many nodes, at most;
/// with a tolerance (m) they adapt. After spread_nodes.
Scene drawn_taut(int nodes, int steps_per_frame, double tolerance = 0.0);

/// A winch, body 2, sets a load of 50 kg, body 0, on the floor by a rope of 0.8 kg/m over a sheave,
/// pays out half a metre more, so that the rope hangs, and lifts the load again, all in 5 s. The
/// rope's nodes adapt, unless the tolerance (m) is 0.
Scene crane(int nodes, int steps_per_frame, double tolerance);

}  // namespace pinchlab::build
