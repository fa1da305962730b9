// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The order of the unknowns of a symmetric system where rows repeat others, as joints do of which a
// linkage has more than it needs: what is left out is to be what the others tell best.

namespace pinchlab {

struct PartSystem;
struct SolveScratch;

/// Rods between bodies that turn about axles come last, those of the shortest levers at the end: as
/// such a rod's line comes to pass through its axles it holds nothing, and what others hold as well
/// is to be known from them. Sets PartSystem::unsure, for number_unknowns, which has cleared it.
void put_levers_last(PartSystem& system, SolveScratch& scratch);

/// Where `repeated` rows (> 0) repeat others, as the system is factored, which of them are left out
/// is the order's choice: to be of those that hardly tell anything new, and so are known the least
/// by what is left of them. Puts all of these last, and factors anew; returns how many repeat
/// others then.
int factor_repeated_last(PartSystem& system, SolveScratch& scratch, int repeated);

}  // namespace pinchlab
