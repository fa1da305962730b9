// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes of impacts, catches, hits and slip whose motion is known: in closed form, or from
// equations of motion between events. Errors are relative to the farthest that a body gets from its
// start.

#include <vector>

#include "analysis/experiments/work_precision.h"

namespace pinchlab::experiments {

Problem bouncing_ball();       ///< ten bounces of restitution 0.8
Problem ball_between_walls();  ///< restitution 1, no gravity
Problem caught_load();         ///< a load on slack cable, stopped dead by it
Problem caught_over_a_peg();   ///< 1 and 3 kg on slack cable over a frictionless peg
Problem two_on_slack_cable();  ///< bodies that fly apart until their cable is taut
Problem galileos_peg();        ///< a pendulum whose cable meets a peg, winds round it and off again
Problem
looping_pendulum();  ///< a bob that winds its cable up on a rod, and so holds 3 times its mass

Problem box_on_a_slope();    ///< slides up it, comes to rest, and slides down again
Problem ball_off_a_table();  ///< rolls over its edge, too fast to stay on it
Problem box_off_a_table();   ///< slides over its edge, tips, and slides off
Problem slip_on_a_drum();    ///< of a cable, there and back, as the drum's motor swings

/// All of the above.
std::vector<Problem> event_problems();

}  // namespace pinchlab::experiments
