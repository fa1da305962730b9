// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Velocities at the time of the positions.
//
// Between intervals every part's velocities are half of its last interval behind its positions
// (Pace::lag). Where something changes them all at once they catch up, by a kick over the lag with
// what bears force at the positions: it is the first part of the kick that would have come, which
// the next interval begins with the rest of. So it is where parts become one.

#include <span>

#include "sim/world.h"

namespace pinchlab {

struct Part;
struct Workspace;

/// Velocities of a part's bodies at the time of their positions (`time`), Pace::lag after those
/// that the world has, in its system.
void find_present_velocities(const Scene& scene, const World& world, const Part& part, double time,
                             Workspace& work);

/// Brings a part's velocities, or those of several, to the time of their positions.
void catch_up(const Scene& scene, World& world, const Part& part, double time, Workspace& work);
void catch_up(const Scene& scene, World& world, std::span<const int> parts, double time,
              Workspace& work);

/// The same of all parts that are so near to others of another lag that they may come to be one.
void bring_together(const Scene& scene, World& world, Workspace& work);

}  // namespace pinchlab
