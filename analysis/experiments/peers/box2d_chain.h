// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A cable as a chain of small rigid links on Box2D: the lumped-mass model of thesis 2.1. Nodes of a
// cable with mass are point masses between distance joints.

#include "analysis/experiments/work_precision.h"

namespace pinchlab::experiments {

/// The chain's knobs. Links are boxes as thick as the cable, held together by revolute joints.
struct Box2dSettings {
  double link_m = 0.1;      ///< length of a link
  double mass_share = 0.1;  ///< mass of the whole chain over that of the lightest load; not of a
                            ///< cable that has mass
  int steps_per_frame = 1;
  int velocity_iterations = 8, position_iterations = 3;
  bool continuous = false;  ///< Box2D's times of impact
  double scale = 1.0;       ///< Box2D's metres a metre: its tolerance is 5 mm of them
};

/// Why the chain cannot take part; empty where it can.
std::string box2d_cannot(const Problem& problem);

/// Simulates the problem's frames. Links of a cable without mass feel no gravity: theirs is
/// the model's error, and the least that way.
Recording run_box2d(const Problem& problem, const Box2dSettings& settings);

}  // namespace pinchlab::experiments
