// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Elastic cables without mass on bodies without friction. What lies there is stretched like what is
// beside it, whatever slides and turns: spans and arcs between rims that hold the cable have, each
// for its length, an even share of the material that they have in all.

#include "sim/world.h"

namespace pinchlab {

/// Whether what lies at a link (or -1) is so stretched. Beside a pinch it stays as it is.
bool lies_relaxed(const World& world, const CableState& cable, int link);

/// Stretches it so at an interval's end, wraps and rest lengths being up to date, as they are
/// afterwards. Where all is slack nothing stays stretched, and rims hold no more than they turn.
void relax_rims(const World& world, CableState& cable);

}  // namespace pinchlab
