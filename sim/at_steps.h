// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A step in one, and a part's solve where events take effect in the step in which they fall
// (Events::at_steps).

namespace pinchlab {

class Stopwatch;
struct Part;
struct Scene;
struct TimeSpan;
struct Workspace;
struct World;

/// Positions are at the step's start, velocities half a step before, or none at time 0, so
/// that the first kick is half as long. That makes semi-implicit Euler a leapfrog.
TimeSpan whole_step(const World& world);

/// Velocities of a part's bodies that meet all of its constraints, in its system, whose forces have
/// been applied; whether the states settled.
bool solve_at_steps(const Scene& scene, const World& world, Workspace& work, const Part& part,
                    const TimeSpan& interval, Stopwatch& watch);

}  // namespace pinchlab
