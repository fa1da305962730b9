// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes whose motion is known: in closed form, from independent equations of motion, or (the
// demonstrations) from their own converged solution.

#include <string>
#include <vector>

#include "analysis/experiments/work_precision.h"

namespace pinchlab::experiments {

Problem atwood();           ///< 1 and 3 kg over a pulley of 2 kg, no slip
Problem slipping_atwood();  ///< the same with friction 0.05: the cable slips
Problem pulley_chain();     ///< 1000 and 999 kg over 81 pulleys of 0.1 kg
Problem swinging_load();    ///< a bob that swings on the cable over two heavy pulleys
Problem roller_on_drum();   ///< a roller over the crown of a wrapped drum, pinched throughout
Problem resting_stack();    ///< four pinched pulleys on a wrapped one, and a weight: all at rest
Problem hanging_load();     ///< 100 kg at rest on two metres of cable

Problem rope_atwood();       ///< 1 and 1.5 kg on a rope of 1.6 kg over a pulley
Problem square_unwinding();  ///< a bob whose cable comes off the corners of a fixed square
Problem hanging_cable();     ///< 2 m of a cable with mass, of 50 pieces, at rest

/// All of the above.
std::vector<Problem> known_problems();

/// Corners, layers, masses and creep whose motion is known from their own solutions only.
std::vector<Problem> finely_solved_problems(int steps_per_frame);

/// A scene against its own solution (pinch, direct) at `steps_per_frame`, over `seconds`: for
/// scenes whose motion is not known otherwise. All bodies are watched, rims too. `on_steps` is the
/// problem's. Throws SceneError where the scene cannot exist, std::runtime_error where its solution
/// is not finite.
Problem own_solution(const std::string& name, const Scene& scene, double seconds,
                     int steps_per_frame, const std::function<void(const World&)>& on_steps = {});

}  // namespace pinchlab::experiments
