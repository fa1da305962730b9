// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Processor instructions a step, counted by valgrind: the same on a busy machine as on a quiet one.

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

/// Whether valgrind is there to count.
bool can_count_instructions();

/// Counts, and writes instructions.csv and instructions.md. The program runs itself under
/// valgrind's callgrind, twice a scene with different numbers of steps; what the difference costs
/// is the steps'. Throws std::runtime_error with the cure where there is no valgrind.
void run_instructions(const Options& options);

/// What runs under valgrind: `steps` steps of scene number `scene` of the list. False if there is
/// no such scene.
bool step_scene(int scene, int steps);

/// Likewise of number `number` of the scenes that grow (growth.h), at a size: `calls` steps, or as
/// many times make_world.
bool step_growing_scene(int number, int size, int calls);

}  // namespace pinchlab::experiments
