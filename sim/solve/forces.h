// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/solve/part_system.h"

namespace pinchlab {

struct Part;
struct Parts;
struct Start;
struct Workspace;
struct World;

/// Of a body by itself, for a velocity kick of `kick` seconds.
Mobility mobility_of(const BodyProperties& body, double kick);

/// Velocities of all bodies that are awake after forces alone have acted for the interval's kick,
/// and what moves the bodies, into their parts' systems.
void apply_forces(const Scene& scene, const World& world, const TimeSpan& interval,
                  Workspace& work);

/// The same of one part.
void apply_forces(const Scene& scene, const World& world, const TimeSpan& interval,
                  const Parts& parts, const Part& part, PartSystem& system);

/// Takes the flow of cables with mass at the middle of the kick, and how their weight moves over
/// during it, the part's velocities after it being those just solved for, into the free velocities
/// and those that follow from them: what this changes in its turn is of the third order of the
/// kick.
void follow_flow(const Scene& scene, const Start& start, const Parts& parts, const Part& part,
                 const TimeSpan& interval, PartSystem& system);

}  // namespace pinchlab
