// SPDX-License-Identifier: GPL-3.0-or-later
// That the page's sentences follow from the numbers.

#include <gtest/gtest.h>

#include "analysis/experiments/accuracy.h"

namespace pinchlab::experiments {
namespace {

/// One scene: our default is second order from 1e-2, another engine is as given.
std::vector<ProblemResult> made_up(double peer_error, double peer_cpu) {
  ProblemResult result;
  result.problem.name = "made-up";
  result.problem.title = "Made up";
  result.problem.reference = "a guess";
  result.problem.length = "a metre";
  for (const Contender& contender : contenders()) {
    double error = 1e-2, cpu = 1e-4;
    for (int steps = 1; steps <= 16; steps *= 2, error /= 4.0, cpu *= 2.0) {
      Rung rung{contender.name, steps, {}};
      rung.trial.finite = contender.name != "thesis";
      rung.trial.error = error;
      rung.trial.cpu_s_per_s = cpu;
      result.rungs.push_back(rung);
    }
  }
  Rung peer{"its setting", 8, {}};
  peer.trial.finite = true;
  peer.trial.error = peer_error;
  peer.trial.cpu_s_per_s = peer_cpu;
  result.peers = {PeerResult{"", {peer}}, PeerResult{"it does not exist", {}}};
  return {result};
}

std::vector<Peer> made_up_peers() {
  Peer there, not_there;
  there.name = "Engine";
  there.version = "1.0";
  there.model = "How it works.";
  not_there.name = "Absent";
  not_there.package = "libabsent-dev";
  return {there, not_there};
}

bool says(const std::string& page, const std::string& words) {
  return page.find(words) != std::string::npos;
}

TEST(AccuracyPage, TellsCheapestOrderAndWhatFailed) {
  const std::string page = accuracy_page(made_up(1e-2, 1e-1), made_up_peers(), Limits(), Limits());
  EXPECT_TRUE(says(page,
                   "| made-up | pinch direct, 1 step: 100 µs | pinch direct, 4 steps: 400 µs "
                   "| pinch direct, 16 steps: 1600 µs | not reached (best 3.9e-05) |"))
      << page;
  EXPECT_TRUE(says(page, "| 2.0 | 100 µs |")) << page;
  EXPECT_TRUE(says(page, "not finite")) << page;
  EXPECT_TRUE(says(page, "Nowhere in this run.")) << page;
  EXPECT_TRUE(says(page, "It is of second order on: made-up.")) << page;
  EXPECT_TRUE(says(page, "`pinch direct` meets the error in 3 of the 3 cases")) << page;
  EXPECT_TRUE(says(page, "`thesis` meets the error in 0 of the 3 cases")) << page;
  EXPECT_TRUE(says(page, "Engine meets 1 of the 3 cases that it can take part in")) << page;
  EXPECT_TRUE(says(page, "100 ms (8 steps), 1e+03 times ours")) << page;
  EXPECT_TRUE(says(page, "`libabsent-dev` was not installed")) << page;
}

TEST(AccuracyPage, SaysWhereAnotherEngineIsBetter) {
  const std::string page = accuracy_page(made_up(1e-7, 1e-5), made_up_peers(), Limits(), Limits());
  EXPECT_TRUE(says(page,
                   "made-up, error 1e-02: Engine, its setting (8 steps) takes 10 µs, "
                   "`pinch direct` 100 µs."))
      << page;
  EXPECT_TRUE(says(page, "`pinch direct` does not reach it")) << page;
}

TEST(AccuracyPage, TellsWhatEventsAtTheStepsCost) {
  std::vector<ProblemResult> results = made_up(1e-2, 1e-1);
  EXPECT_FALSE(
      says(accuracy_page(results, made_up_peers(), Limits(), Limits()), "accuracy-events"));
  results[0].events = true;
  results[0].at_steps = ladder(results[0].rungs, "pinch direct");
  for (Rung& rung : results[0].at_steps) {  // of first order, at half the time
    rung.setting = events_at_steps;
    rung.trial.error = 1e-2 / rung.steps_per_frame;
    rung.trial.cpu_s_per_s *= 0.5;
  }
  const std::string page = accuracy_page(results, made_up_peers(), Limits(), Limits());
  EXPECT_TRUE(says(page, "(accuracy-events.svg)")) << page;
  EXPECT_TRUE(says(page,
                   "with events at their time, exact on 0 of 1, of order made-up 2.0; with events "
                   "at the steps, exact on 0 of 1, of order made-up 1.0. It meets 3 of 4 errors "
                   "(scene and error) with events at their time, 2 with events at the steps; where "
                   "both do, the former takes 0.5 to 2 times the latter's time"))
      << page;
  EXPECT_TRUE(says(page,
                   "| made-up | at the steps | 1.0e-02 | 2.5e-03 | 6.3e-04 | too slow | 1.0 "
                   "| 50 µs | 800 µs | not reached | not reached |"))
      << page;
}

TEST(AccuracyEvents, EverySceneIsExactOrOfSecondOrder) {
  int scenes = 0;
  for (const ProblemResult& result : scenes_of_known_motion()) {
    if (!result.events) continue;
    ++scenes;
    const auto run = [&](int steps) { return simulate(result.problem, Method::pinch, steps); };
    const std::vector<Rung> rungs =
        climb(result.problem, "pinch direct", run, 64, Limits{0.0, infinity});
    const std::string order = order_text(result.problem, rungs);
    EXPECT_TRUE(order == "exact" || order == "1.9" || order == "2.0" || order == "2.1")
        << result.problem.name << ": " << order;
    EXPECT_LE(rungs.front().trial.error, 3e-3) << result.problem.name << " at one step a frame";
  }
  EXPECT_EQ(scenes, 11);
}

// Elastic impacts that take effect a step late are wrong for good.
TEST(AccuracyEvents, EventsAtTheStepsAreOfFirstOrderOnBounces) {
  for (const ProblemResult& result : scenes_of_known_motion()) {
    if (result.problem.name != "bouncing-ball") continue;
    Configuration configuration = Method::pinch;
    configuration.events = Events::at_steps;
    const auto run = [&](int steps) { return simulate(result.problem, configuration, steps); };
    const std::vector<Rung> rungs =
        climb(result.problem, events_at_steps, run, 256, Limits{0.0, infinity});
    EXPECT_NEAR(observed_order(rungs, 1e-12), 1.0, 0.2);
  }
}

}  // namespace
}  // namespace pinchlab::experiments
