// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The direct solve: which segments are taut, which contacts bear force, what sticks and what slips.

#include "sim/world.h"

namespace pinchlab {

/// Finds impulses for the rows of a part (an index into Parts::list), which stand in
/// world.scratch.rows, such that the velocities after a kick of `kick` seconds (s) meet every row:
/// unilateral rows complementary, friction inside its bounds, sliding cables by the capstan law.
/// Starts from the states of the last step; writes velocities, states and forces.
///
/// Each guess of the states gives one linear system, solved directly. Contradicted states are
/// flipped all at once while their number falls (block pivoting, Judice & Pires 1994), then one by
/// one in a fixed, irregular order. Where a slack cable is pulled tight, segments near those that
/// get taut are made taut ahead of their turn. What negative impulses round-off has made is no
/// contradiction. If friction makes the states cycle, what has flipped sticks for the rest of the
/// step, and diagnostics.fallbacks counts it; projected sweeps are the last resort.
void solve_direct(const Scene& scene, World& world, int part, double kick);

/// Keeps states of rows and runs for the next step, and reports forces.
void store_states(World& world, double kick);

}  // namespace pinchlab
