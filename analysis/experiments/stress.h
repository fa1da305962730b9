// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a step costs as scenes grow: the thesis' stress test (3.2.1; Figures 5.1 to 5.3).

#include <optional>
#include <string>
#include <vector>

#include "analysis/experiments/element_counts.h"
#include "analysis/experiments/growth.h"
#include "analysis/experiments/step_cost.h"
#include "demos/scenes/library.h"

namespace pinchlab::experiments {

/// One way to simulate the stress scene.
struct StressCase {
  const char* name;
  Configuration configuration;
  double spacing;  // m
};

/// `pinch` and `thesis` on the pinched scene, `cable` and `thesis cable` on the free one, and ours
/// with one choice of the thesis each: `iterative`, `all pairs`, `three rows`.
const std::vector<StressCase>& stress_cases();

struct StressResult {
  std::string name;  // of the case
  int load = 0;
  ElementCounts elements;
  Tensions tensions;
  StepCost cost;
};

constexpr std::int64_t steps_of_bare = 5000;  // after which its scenes begin again

/// Ours against the bare pass over as many segments.
struct BareResult {
  std::string scene;
  std::size_t segments = 0;
  CallCost bare, step;
  double ratio() const { return step.seconds.median / bare.seconds.median; }
};

/// Solves a step where the cable is as long as its path: no tension, and many states fit.
struct SlackResult {
  int load = 0;
  double solves_with = 0.0, solves_without = 0.0;
  std::int64_t fallbacks_without = 0;
};

/// The stress scene at rest, with sleep: when all of it had fallen asleep (s of its own time;
/// infinity: not within `most_s`), and the processor time of a step awake and after that.
struct SleepResult {
  static constexpr double most_s = 2.0;
  int load = 0;
  double after_s = 0.0;
  double awake_s = 0.0, asleep_s = 0.0;

  bool asleep() const { return after_s <= most_s; }
};

struct StressResults {
  std::vector<StressResult> steps;  // by load, then case
  std::vector<BareResult> bare;     // the first is the one that was asked for
  std::vector<SlackResult> slack;
  std::vector<SleepResult> sleep;
  std::vector<GrowthResult> growth;  // of other scenes
  IndependenceResult independence;
};

/// Of that case and load, or null.
const StressResult* find(const StressResults& results, const std::string& name, int load);

/// The page and its figures, from what was measured.
std::string stress_page(const StressResults& results);
void draw_stress(const StressResults& results, Output& output);

/// Measures, and writes stress.csv, stress-stages.csv, figures and stress.md.
void run_stress(const Options& options);

}  // namespace pinchlab::experiments
