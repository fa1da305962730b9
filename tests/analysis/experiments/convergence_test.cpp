// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/experiments/event_scenes.h"
#include "demos/scenes/scene_json.h"

namespace pinchlab::experiments {
namespace {

double error(const Problem& problem, int steps_per_frame) {
  const Recording run = simulate(problem, Method::pinch, steps_per_frame);
  EXPECT_TRUE(run.finite) << problem.name;
  return distance(run.motion, problem.exact, false).largest_m;
}

// Straight motion between events is exact, and the events happen at their time.
TEST(EventScenes, StraightMotionThroughEventsIsExactAtEveryStep) {
  for (const Problem& problem : event_problems()) {
    if (problem.doubt_m > 0.0) continue;
    for (const int steps : {1, 3, 4, 16}) {
      EXPECT_LE(error(problem, steps), 1e-9) << problem.name << " at " << steps;
    }
  }
}

// The capstan law holds with what of the cable lies on the rod when the interval begins: at its end
// it is of order 1, where the bob winds the cable up.
TEST(EventScenes, CurvedMotionThroughEventsIsOfSecondOrder) {
  for (const Problem& problem : {galileos_peg(), looping_pendulum(), box_off_a_table()}) {
    const auto run = [&](int steps) { return simulate(problem, Method::pinch, steps); };
    const std::vector<Rung> rungs = climb(problem, "located", run, 128, Limits{0.0, infinity});
    // By least squares: where in its step the cable comes to stick changes the error somewhat.
    EXPECT_GE(observed_order(rungs, 1e-12), 1.9) << problem.name;
    EXPECT_GT(rungs.back().trial.error * problem.length_m, problem.doubt_m) << problem.name;
  }
}

/// The demonstration with fixed steps, of which every body is watched in every frame.
Problem demonstration(const char* name) {
  Problem problem;
  problem.name = name;
  problem.scene =
      read_scene_file(std::string(PINCHLAB_SOURCE_DIR "/demos/") + name + ".json").scene;
  problem.scene.error = 0.0;
  problem.frames = problem.scene.frame_count - 1;
  for (std::size_t b = 0; b < problem.scene.bodies.size(); ++b) problem.watched.push_back(b);
  return problem;
}

/// What halving the steps changes.
double changed_by_half_steps(const Problem& problem, int steps_per_frame) {
  const Recording one = simulate(problem, Method::pinch, steps_per_frame);
  const Recording other = simulate(problem, Method::pinch, 2 * steps_per_frame);
  EXPECT_TRUE(one.finite && other.finite) << problem.name;
  return distance(one.motion, other.motion, false).largest_m;
}

// Spans between bodies that come to pinch them, or are torn apart, vanish and come into being as a
// root (sim/motion/vanishing.h), bodies bounce to rest on one another, and a motor gives all it
// can: of order 0.5 to 1.1 once.
TEST(Convergence, DemonstrationsThatPinchAreOfSecondOrder) {
  for (const char* name : {"01-roll-over", "04-two-blocking", "05-notch"}) {
    const Problem problem = demonstration(name);
    const double coarse = changed_by_half_steps(problem, 1);
    const double fine = changed_by_half_steps(problem, 64);
    const double order = std::log2(coarse / fine) / 6.0;
    EXPECT_GE(order, 1.8) << name << ": " << coarse << ", " << fine;
  }
}

}  // namespace
}  // namespace pinchlab::experiments
