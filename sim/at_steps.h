// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A part's solve where events take effect in the step in which they fall (Events::at_steps).

namespace pinchlab {

class Stopwatch;
struct Part;
struct Scene;
struct TimeSpan;
struct Workspace;
struct World;

/// Velocities of a part's bodies that meet all of its constraints, in its system, whose forces have
/// been applied; whether the states settled.
bool solve_at_steps(const Scene& scene, const World& world, Workspace& work, const Part& part,
                    const TimeSpan& interval, Stopwatch& watch);

}  // namespace pinchlab
