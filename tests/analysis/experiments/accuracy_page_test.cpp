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

}  // namespace
}  // namespace pinchlab::experiments
