// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a step costs, whole and by stage.

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "analysis/experiments/experiment.h"
#include "sim/step.h"

namespace pinchlab::experiments {

constexpr auto stage_count = static_cast<std::size_t>(Stage::count);

/// How long to measure.
struct Effort {
  double seconds = 3.0;       ///< at most, of processor time, once there are 5 samples
  std::size_t samples = 300;  ///< at most
};

/// What --quick asks for, or the whole.
Effort effort_of(const Options& options);

/// Throws std::runtime_error where the step is not finite.
void step_or_throw(const Scene& scene, World& world, Workspace& work);

/// Processor time of one call of `run`, s. A sample is the mean of so many calls in a row that the
/// clock's own time is less than 1 % of it.
struct CallCost {
  Spread seconds;
  std::int64_t calls = 0;  // timed
};
CallCost measure_call(const std::function<void()>& run, const Effort& effort);

/// Of two functions by turns, so that what disturbs the machine disturbs both.
struct BothCosts {
  CallCost first, second;
  std::vector<double> differences;  // s, first less second, of neighbouring batches
};
BothCosts measure_both(const std::function<void()>& first, const std::function<void()>& second,
                       const Effort& effort);

struct StepCost {
  Spread step_s;                            // processor time of a whole step
  std::array<Spread, stage_count> stage_s;  // clock time of each stage, without that of the clock
  std::int64_t steps = 0;                   // timed
  double solves = 0.0;                      // of the active set, or 1, a step
  std::int64_t fallbacks = 0;               // steps whose active set did not settle
};

/// Goes on with `world`. Throws std::runtime_error where a step is not finite.
StepCost measure_steps(const Scene& scene, World& world, Workspace& work, const Effort& effort);

/// Least and greatest tension, N, of the segments that are not the zero-length parts of a
/// non-transitional pinch (those hold the change of tension, not the tension).
struct Tensions {
  double least = 0.0, greatest = 0.0;
};
Tensions tensions_of(const World& world);

/// A stage under the name that the thesis has for it.
const char* thesis_name(Stage stage);

/// "12.3 µs": three digits with the unit that suits.
std::string time_text(double seconds);

}  // namespace pinchlab::experiments
