// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What all of MuJoCo's models have in common.

#include <mujoco/mujoco.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/experiments/work_precision.h"

namespace pinchlab::experiments {

/// What MuJoCo can be set to.
struct MujocoSettings {
  std::string integrator = "Euler";  ///< Euler or RK4
  bool leapfrog =
      false;  ///< starts with velocities half a step back, which makes Euler second order
  int steps_per_frame = 1;
  double time_constant_steps = 2.0;  ///< of the constraint, in steps; MuJoCo allows no less than 2
};

using MujocoModel = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using MujocoData = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

/// Throws std::runtime_error with MuJoCo's words where it refuses the model.
MujocoModel load_mujoco(const std::string& xml);

/// Simulates the problem's frames; `places` reads those of the watched bodies.
Recording record_mujoco(const Problem& problem, const mjModel& model, mjData& data,
                        const MujocoSettings& settings,
                        const std::function<std::vector<Place>()>& places);

}  // namespace pinchlab::experiments
