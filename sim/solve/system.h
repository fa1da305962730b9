// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The linear system for one guess of the active set's states.

namespace pinchlab {

struct PartSystem;
struct SolveScratch;

/// Solves for the impulses of all rows that bear one, given the rows' and runs' states, and sets
/// impulses, velocities and the rows' speeds accordingly.
///
/// Unknowns z are impulses of rows, or of groups of rows that depend on one another: p = F z.
/// Equations are rows, or sums G of them: G (J (v* + M^-1 J^T p) + bias + compliance p) = 0. The
/// matrix G (J M^-1 J^T + compliance) F is narrow in the order of PartSystem::order and is factored
/// directly. Where nothing slides F and G are the identity and the matrix is symmetric. Where
/// constraints repeat one another, the solution of least norm is taken, each impulse weighted by
/// the root of its row's diagonal: between the same two bodies, as for equally stiff cables.
void solve_for_states(PartSystem& system, SolveScratch& scratch);

/// The same where only biases have changed since it found a solution that is SolveScratch::direct,
/// but for round-off of that change.
void correct_solution(PartSystem& system, SolveScratch& scratch);

/// Numbers the unknowns of such a system and lists its groups and equations, of states whose
/// solution is known.
void express_states(PartSystem& system, SolveScratch& scratch);

/// Velocities of the part's bodies = free velocities + what the rows' impulses do.
void apply_impulses(PartSystem& system);

}  // namespace pinchlab
