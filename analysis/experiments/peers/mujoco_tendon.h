// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A cable as a spatial tendon of MuJoCo, held at its length by an equality constraint.

#include <string>

#include "analysis/experiments/peers/mujoco_run.h"

namespace pinchlab::experiments {

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
