// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The direct solve: which segments are taut, which contacts bear force, what sticks and what slips.

#include "sim/world.h"

namespace pinchlab {

struct Part;
struct Parts;
struct PartSystem;
struct SolveScratch;

/// Finds impulses for the rows of a part such that the velocities meet every row: unilateral rows
/// complementary, friction inside its bounds, sliding cables by the capstan law. Starts from the
/// states of the last step; writes the part's velocities and its rows' impulses and states. Returns
/// whether the states settled.
///
/// Each guess of the states gives one linear system, solved directly. Contradicted states are
/// flipped all at once while their number falls (block pivoting, Judice & Pires 1994), then one by
/// one in a fixed, irregular order. Where a slack cable is pulled tight, segments near those that
/// get taut are made taut ahead of their turn, and where bodies in touch are struck, contacts that
/// the blow runs through bear force ahead of theirs. What negative impulses round-off has made is
/// no contradiction. If friction makes the states cycle, all of them are found at once
/// (complementary.h). Where there is no solution, or too much for that, they are sought once more
/// from where nothing slides, and if they cycle again what has flipped sticks for the rest of the
/// step; projected sweeps are the last resort.
bool solve_direct(const World& world, const Parts& parts, const Part& part, PartSystem& system,
                  SolveScratch& scratch);

/// As solve_direct, where since the last solve of these rows nothing but their biases has changed.
/// Where that contradicts no state, the last solution is corrected.
bool solve_again(const World& world, const Parts& parts, const Part& part, PartSystem& system,
                 SolveScratch& scratch);

}  // namespace pinchlab
