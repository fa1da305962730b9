// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Motors that hold an angular velocity, as far as they can.

#include "base/at.h"
#include "sim/solve/foresight.h"
#include "sim/solve/part_system.h"
#include "sim/solve/rows.h"
#include "sim/workspace.h"

namespace pinchlab {

/// Adds the motor of a driven body at its place in the part. It holds `speed` (rad/s) if the torque
/// for that is within its limit over the kick, and gives otherwise; `before` is the body's angular
/// velocity before the kick (rad/s). In an instant a limited torque is as good as none,
/// and a motor without a limit holds what there is.
void add_motor(const BodyProperties& body, int place, double speed, double before, double kick,
               PartSystem& system);

/// Adds one without a limit that is to turn at `speed`, but has stalled, for an instant: its body
/// turns at `before` (rad/s).
void add_stalled_motor(const BodyProperties& body, int place, double speed, double before,
                       PartSystem& system);

/// Whether it can hold its speed by itself, or gives all it can.
void find_first_state(Motor& motor);

/// Times a rim's speed: what cables make faster than that, they throw. A body that a motor drives
/// by a cable goes at its rim's speed, or at some times that where the cable bends.
constexpr double thrown = 10.0;

/// What the motors do to the free velocities and mobilities of the part's bodies.
void drive(PartSystem& system);

/// Whether motors with a limit have to do something else than what was just solved for. What a
/// motor gives is what its body's angular momentum has changed by otherwise than by rows, M = I
/// (omega+ - omega-) - sum p j. One that holds its speed gives where M is beyond its limit, one
/// that gives all it can holds its speed where it would turn faster. One without a limit that has
/// stalled lets nothing turn its body back, nor further back than it turned before, as long as that
/// takes a torque its own way.
bool change_limited_motors(PartSystem& system);

/// The same for all motors. Where cables that pull at its body cannot give and contradict a motor
/// without a limit, or could only give by throwing a body, it stalls: it leaves its body to the
/// cables for this kick, unless that does not help and it threw nothing.
bool change_motors(const World& world, const Parts& parts, const Part& part, PartSystem& system,
                   SolveScratch& scratch);

/// Lets all motors that hold a speed leave their bodies to the rows; whether there are any.
bool stall_all(PartSystem& system);

/// Of what a part's motors do, in one solve. Each has five states (MotorState): eight changes are
/// more than one goes through, and end a cycle.
constexpr int most_motor_changes = 8;

/// Makes the rows of a part and solves them by `solve`, again where its motors change what they do;
/// returns what the last solve did. With `most_changes` of 0 they do what they do.
template <typename Solve>
bool solve_with_motors(const Scene& scene, const World& world, Workspace& work, const Part& part,
                       const TimeSpan& interval, Stopwatch& watch, Solve solve,
                       int most_changes = most_motor_changes) {
  PartSystem& s = at(work.systems, part.system);
  if (!s.motors.empty()) s.unconstrained = s.free_velocity;
  for (int changes = 0;; ++changes) {
    make_rows(scene, world, work.parts, part, interval, s, work.solve, watch);
    if (interval.foreseen) foresee(world, interval.length, s);
    const bool settled = solve();
    if (s.motors.empty() || changes == most_changes) return settled;
    if (!change_motors(world, work.parts, part, s, work.solve)) return settled;
    s.free_velocity = s.unconstrained;  // which rows of elastic segments may have changed
    drive(s);
  }
}

}  // namespace pinchlab
