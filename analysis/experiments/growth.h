// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How the cost of scenes of many independent things grows with their number.

#include <string>
#include <vector>

#include "analysis/experiments/step_cost.h"
#include "sim/scene.h"

namespace pinchlab::experiments {

/// One kind of scene at several sizes, two decades apart: what a step costs, or making the world.
struct GrowingScene {
  const char* what;
  std::vector<int> sizes;
  Scene (*scene)(int size);
  int steps = 1;  // timed at once from the start, where what happens differs from step to step;
                  // 0: its make_world
};

/// Swinging cables, balls that bounce, discs that land on spans, discs on walls, pulleys without
/// friction under one cable, and make_world of swinging cables and of the pinched stress scene.
const std::vector<GrowingScene>& growing_scenes();

/// One kind of scene at several sizes, two decades apart: the processor time of a step, or of
/// making the world.
struct GrowthResult {
  std::string what;
  std::vector<int> sizes;
  std::vector<double> seconds;  // medians
  double exponent = 0.0;
};

std::vector<GrowthResult> measure_growth(const Effort& effort);

/// What independent parts cost one another, each figure a median over one step of a resting cable.
struct IndependenceResult {
  double two_cables = 0.0;   // times, of two resting cables that share nothing
  double with_a_disc = 0.0;  // times, of one resting cable beside a falling disc
  double velocities = 0.0;   // times, of velocities_now against its step on a swinging chain
};
IndependenceResult measure_independence(const Effort& effort);

}  // namespace pinchlab::experiments
