// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a part's solve has found, written into the World.

#include "sim/world.h"

namespace pinchlab {

struct CapstanScratch;
struct Part;
struct Parts;
struct PartSystem;

/// Writes the velocities of the part's bodies, and for the next step and for readers the states and
/// forces (N, impulses over the kick of `kick` seconds) of its segments, links and contacts. At an
/// instant (`kick` is 0) the forces stay.
void store_solution(const Parts& parts, const Part& part, PartSystem& system,
                    const CapstanScratch& capstan, double kick, World& world);

/// Of these the tensions only, of an interval that is not to be.
void store_tensions(PartSystem& system, double kick, World& world);

}  // namespace pinchlab
