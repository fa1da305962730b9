// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Processor instructions a step, counted by valgrind: the same on a busy machine as on a quiet one.

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

/// Whether valgrind is there to count.
bool can_count_instructions();

/// Counts, and writes instructions.csv and instructions.md. A program of its own (count_main.cpp)
/// runs under valgrind's callgrind, twice a scene with different numbers of steps; what the
/// difference costs is the steps'. Throws std::runtime_error with the cure where there is no
/// valgrind, or where that program is missing.
void run_instructions(const Options& options);

}  // namespace pinchlab::experiments
