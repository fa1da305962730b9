// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The iterative solve: projected Gauss-Seidel sweeps, as in the thesis and in most engines.

namespace pinchlab {

struct Part;
struct Parts;
struct PartSystem;
struct SolveScratch;
struct SweepScratch;
struct World;

/// Does what solve_direct (active_set.h) does, by configuration.iterations sweeps over all rows,
/// starting from no impulse (thesis: Solver). Of a violated position a row asks to make up a part
/// only, 0.2 for cables and 0.7 for contacts; one that is not violated may close entirely.
///
/// Where a cable may slide over a body, the speed of slip is one more unknown: a sweep moves it
/// until the tensions before and after obey the capstan law. The more sweeps, the nearer to
/// solve_direct. With a few, tensions are too low and cables give; nothing is kept from step to
/// step.
void solve_iterative(const World& world, const Parts& parts, const Part& part, PartSystem& system,
                     SolveScratch& scratch, SweepScratch& sweeps);

/// The middle bodies of pinches with three rows: which of them let the cable slide through. After
/// store_solution (solution.h).
void store_middles(const PartSystem& system, const SolveScratch& scratch,
                   const SweepScratch& sweeps, World& world);

}  // namespace pinchlab
