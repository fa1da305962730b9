// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// An order of the rows in which the solver's matrix is narrow.

#include "sim/world.h"

namespace pinchlab {

/// Lists the rows that couple each mobile body, and orders the rows by reverse Cuthill-McKee (1969)
/// so that coupled rows come close together: along a cable, one after the other. Nothing is done
/// while the rows couple the same bodies as in the last step.
void order_rows(World& world);

}  // namespace pinchlab
