// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The matrix of a part where nothing slides: J M^-1 J^T + compliance, of the rows that bear force.

namespace pinchlab {

struct PartSystem;
struct SolveScratch;

/// Assembles and factors what has changed of it, into PartSystem::ldl; returns how many rows repeat
/// others.
int factor_symmetric(PartSystem& system, SolveScratch& scratch);

}  // namespace pinchlab
