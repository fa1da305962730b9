// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is done where no states are found that fit one another.

namespace pinchlab {

struct PartSystem;
struct SolveScratch;

/// Impulses below zero are within round-off of it: makes them zero.
void clear_negative(PartSystem& system);

/// Projected Gauss-Seidel from the present impulses: what is done when friction makes the states
/// cycle. Sliding runs are held for this step; every impulse stays inside its bounds, so no energy
/// comes in.
void sweep_rows(PartSystem& system, SolveScratch& scratch);

}  // namespace pinchlab
