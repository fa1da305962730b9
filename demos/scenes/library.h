// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The scenes that tests and experiments share, by rule instead of by file: thesis 3.2, Figure 3.1.

#include "sim/scene.h"

namespace pinchlab {

/// Pulleys of radius 0.5 m and a cable of half width 0.05 m pinch where centres lie nearer than
/// 2 r + 2 w = 1.1 m. Half a nanometre less makes every pinch certain in floating point; more would
/// be a gap narrower than the cable, which cannot exist and which make_world refuses.
constexpr double pinched_spacing = 1.1 - 5e-10;  // m
constexpr double free_spacing = 1.2;             // m, of Figure 3.1b: nothing is pinched

/// How the stress scenes' cable is strung: EA, and by how much of its free length it is stretched.
/// The thesis says that all segments were in constant tension, not how much. A soft cord, 1 %
/// stretched, carries 100 N, ten times a pulley's weight.
constexpr double stress_stiffness = 1e4;  // N
constexpr double stress_strain = 0.01;

/// Figures 3.1a (pinched_spacing) and 3.1b (free_spacing), repeated `load` times: 4 pulleys with
/// fixed axles a unit on one cable anchored at both ends, no slip, all of it in tension.
Scene stress_scene(int load, double spacing);
/// The same with a cable that cannot stretch and carries nothing.
Scene slack_stress_scene(int load, double spacing);

/// Figure 3.1c, repeated `load` times: two wrapped pulleys with fixed axles a unit, over and under
/// in turn, and on rails above them small pulleys of 1 kg. `pinching` ones lie on the wrap of the
/// first, `other` ones on the bare top of the second. The cable is strung as in stress_scene.
Scene pinch_detection_scene(int load, bool pinching, bool other);

/// 1000 kg and 999 kg on one cable over `pulleys` (odd) pulleys of 0.1 kg with fixed axles,
/// wrapped over and under in turn: the mass ratio of 1e4 at which sweeps do not converge.
Scene chain_scene(int pulleys);

/// A weight that swings for ever on a cable over `pulleys` (odd) pulleys with fixed axles: never at
/// rest, and without contacts, pinches, slip and loops.
Scene swinging_scene(int pulleys);

/// `count` cables apart from each other, each from an anchor over a pulley with a fixed axle to a
/// hanging weight (thesis 7.1). The first `moving` weights swing, the others hang still.
Scene disconnected_scene(int count, int moving);

}  // namespace pinchlab
