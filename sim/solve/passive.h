// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A solve that makes no energy.

#include "sim/stages.h"
#include "sim/world.h"

namespace pinchlab {

struct Part;
struct Parts;
struct PartSystem;
struct SolveScratch;
struct TimeSpan;
struct Workspace;

/// Whether the impulses p that were just solved for have given the bodies more energy than they
/// had: sum p (J v- + J v+) / 2 > 0 beyond round-off and what is made up for of it. That is exactly
/// the change of (kinetic) energy that they made, with the work of motors taken out; and so is what
/// the curvature of ways makes of it (Row::curved), which chords of a curve take or give and the
/// curve does not. Elastic segments may give back what they store: where one bears force, the
/// answer is no.
bool makes_energy(const PartSystem& system, const SolveScratch& scratch);

/// As solve_direct. Constraints, Coulomb's law and the capstan law only ever take energy from
/// motion as it flows; taken over a whole kick they may make some, where they turn the way of
/// sliding, or where the states did not settle. Then cables slide on smooth bodies alone and bare
/// surfaces do not rub: what is left is a projection. Where even that makes energy, its matrix is
/// next to singular, and sweeps that start from no impulse stop short of the solution: each of them
/// only takes energy.
bool solve_passively(const World& world, const Parts& parts, const Part& part, PartSystem& system,
                     SolveScratch& scratch);

/// Makes and solves the rows of a part so, its light bodies steadied (light_bodies.h) but where
/// that makes energy, with at most so many changes of what its motors do (motors.h).
bool solve_steadily(const Scene& scene, const World& world, Workspace& work, const Part& part,
                    const TimeSpan& interval, int changes_of_motors, Stopwatch& watch);

}  // namespace pinchlab
