// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "analysis/experiments/accuracy_scenes.h"
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

TEST(EventScenes, APendulumThatMeetsAPegIsOfSecondOrder) {
  const Problem problem = galileos_peg();
  const double coarse = error(problem, 4), fine = error(problem, 32);
  EXPECT_LE(fine, coarse / 8.0 / 8.0 * 1.3);  // order 1.9
  EXPECT_GT(fine, problem.doubt_m);
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

// Spans between bodies that come to pinch them vanish as a root (sim/motion/vanishing.h), bodies
// bounce to rest on one another, and a motor gives all it can: of order 0.5 to 1.1 once.
TEST(Convergence, DemonstrationsThatPinchAreOfSecondOrder) {
  for (const char* name : {"01-roll-over", "04-two-blocking", "05-notch"}) {
    const Problem problem = demonstration(name);
    const double coarse = changed_by_half_steps(problem, 1);
    const double fine = changed_by_half_steps(problem, 64);
    const double order = std::log2(coarse / fine) / 6.0;
    // The bounces of the second come to rest over and over, each time to some 1e-7 m.
    EXPECT_GE(order, name == std::string("04-two-blocking") ? 1.5 : 1.8)
        << name << ": " << coarse << ", " << fine;
  }
}

}  // namespace
}  // namespace pinchlab::experiments
