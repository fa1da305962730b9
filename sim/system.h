// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The linear system for one guess of the active set's states.

#include "sim/world.h"

namespace pinchlab {

/// Solves for the impulses of all rows that bear one, given the rows' and runs' states, and sets
/// impulses, velocities and the rows' speeds accordingly.
///
/// Unknowns z are impulses of rows, or of groups of rows that depend on one another: p = F z.
/// Equations are rows, or sums G of them: G (J (v* + M^-1 J^T p) + bias + compliance p) = 0. The
/// matrix G (J M^-1 J^T + compliance) F is narrow in the order of scratch.order and is factored
/// directly. Where nothing slides F and G are the identity and the matrix is symmetric. Where
/// constraints repeat one another, the solution of least norm is taken, as for equally stiff
/// cables.
void solve_for_states(World& world);

/// The part whose rows stand in world.scratch.rows.
inline const Part& part_being_solved(const World& world) {
  return world.scratch.parts.list[static_cast<std::size_t>(world.scratch.active_set.part)];
}

/// Velocities of the part's bodies = free velocities.
void release_bodies(World& world);

/// Velocities of the part's bodies = free velocities + what the rows' impulses do.
void apply_impulses(World& world);

/// J v + bias at the present velocities (m/s).
double row_speed(const World& world, const Row& row);

/// Changes the velocities of the row's bodies by an impulse on it (N s).
void push(World& world, const Row& row, double impulse);

}  // namespace pinchlab
