// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A cable as a spatial tendon of MuJoCo, held at its length by an equality constraint.

#include <string>

#include "analysis/experiments/work_precision.h"

namespace pinchlab::experiments {

/// What a spatial tendon can be set to.
struct MujocoSettings {
  std::string integrator = "Euler";  ///< Euler or RK4
  bool leapfrog =
      false;  ///< starts with velocities half a step back, which makes Euler second order
  int steps_per_frame = 1;
  double time_constant_steps = 2.0;  ///< of the constraint, in steps; MuJoCo allows no less than 2
};

/// Why a tendon cannot take part; empty where it can.
std::string mujoco_cannot(const Problem& problem);

/// The model in MuJoCo's XML. Loads are point masses with two slides each, and pulleys cylinders
/// that stand still: a tendon runs over them without friction, so that the inertia of pulleys is
/// put on a load that moves straight along the cable, which is exact without slip.
std::string mujoco_model(const Problem& problem, const MujocoSettings& settings);

/// Simulates the problem's frames. Throws std::runtime_error with MuJoCo's words where it refuses
/// the model.
Recording run_mujoco(const Problem& problem, const MujocoSettings& settings);

}  // namespace pinchlab::experiments
