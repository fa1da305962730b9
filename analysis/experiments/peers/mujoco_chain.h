// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A chain of nodes as a chain of hinged links of MuJoCo: its generalized coordinates.

#include <string>

#include "analysis/experiments/peers/mujoco_run.h"

namespace pinchlab::experiments {

/// Why such a chain cannot take part; empty where it can. For problems of nodes alone (is_chain).
std::string mujoco_chain_cannot(const Problem& problem);

/// The model in MuJoCo's XML. Each node is a point mass at the end of a link, which turns about the
/// node before: no length can be wrong. Where the chain's other end is
/// fixed too, the last piece is a tendon, held at its length as stiffly as MuJoCo allows.
std::string mujoco_chain_model(const Problem& problem, const MujocoSettings& settings);

/// Simulates the problem's frames.
Recording run_mujoco_chain(const Problem& problem, const MujocoSettings& settings);

}  // namespace pinchlab::experiments
