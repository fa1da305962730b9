// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "analysis/experiments/accuracy_scenes.h"
#include "analysis/experiments/event_scenes.h"

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

}  // namespace
}  // namespace pinchlab::experiments
