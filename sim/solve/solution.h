// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a part's solve has found, written into the World.

#include "sim/world.h"

namespace pinchlab {

struct CapstanScratch;
struct Part;
struct Parts;
struct PartSystem;
struct TimeSpan;

/// Writes the velocities of the part's bodies, and for the next step and for readers the states and
/// forces (N, impulses over the kick) of its segments, links and contacts. Where impulses do not
/// tell forces, as at an instant, these stay.
void store_solution(const Parts& parts, const Part& part, PartSystem& system,
                    const CapstanScratch& capstan, const TimeSpan& interval, World& world);

/// Of these the tensions only, of an interval that is not to be.
void store_tensions(PartSystem& system, double kick, World& world);

}  // namespace pinchlab
