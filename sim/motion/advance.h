// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A step whose events happen at their time.
//
// An event is what changes the velocities, or the course of a cable, all at once: a contact that
// closes, a slack cable that is pulled tight, a body that meets a span, a link that comes off. A
// step is divided at each of them:
//
//   interval   kick by forces and constraints over [-lag, h/2] about the positions' time (leapfrog,
//              of second order for any sequence of lengths h), then positions move on by h. The
//              constraints hold at the interval's end: SHAKE, by simple iteration with the factors
//              at hand (Ryckaert, Ciccotti & Berendsen 1977). What overshoots an event is tried
//              again, shorter: regula falsi on what is left of its clearance.
//   event      velocities at its time, from half a kick with the old constraints; then the cable's
//              course changes, and an impact (impact.h) makes the velocities fit it.
//
// Where nodes of hanging cables swing faster than a step can follow, it is divided as well
// (cable/waves.h), and where a span vanishes (vanishing.h).
//
// Parts that cannot meet within the step are divided each by its own events (neighbourhoods.h), and
// each part has its own pace: velocities of two are brought to one time only where they may become
// one.
//
// After so many events in a step nothing rebounds any more, so that a body that chatters comes to
// rest (Diagnostics::clusters); after twice as many the rest of the step is met at once, by
// constraints that bear force as early as it takes.
//
// What no interval has put right, as where a constraint has no gradient, is repaired in the
// positions alone: a repair never becomes velocity.

#include "sim/stages.h"
#include "sim/world.h"

namespace pinchlab {

struct Workspace;

/// Moves the world on by world.step_length, all but World::step, which is the caller's.
/// StepStatus::failed: as step().
StepStatus advance(const Scene& scene, World& world, Workspace& work, StageTimes* times);

}  // namespace pinchlab
