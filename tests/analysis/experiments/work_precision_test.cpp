// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/work_precision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "analysis/experiments/accuracy_scenes.h"

namespace pinchlab::experiments {
namespace {

Motion motion_of(const std::vector<double>& xs) {
  Motion motion;
  for (const double x : xs) motion.push_back({Place{Vec2(x, 0.0), 0.0}});
  return motion;
}

Rung rung(const std::string& setting, int steps, double error, double cpu, bool finite = true) {
  Rung r{setting, steps, {}};
  r.trial.finite = finite;
  r.trial.error = error;
  r.trial.cpu_s_per_s = cpu;
  return r;
}

TEST(WorkPrecision, DistanceIsTheLargestAndTheMeanOverFrames) {
  const Distance d = distance(motion_of({0.0, 1.0, 2.0}), motion_of({0.0, 4.0, -2.0}), false);
  EXPECT_DOUBLE_EQ(d.largest_m, 4.0);
  EXPECT_DOUBLE_EQ(d.rms_m, std::sqrt((9.0 + 16.0) / 3.0));
  EXPECT_DOUBLE_EQ(reach(motion_of({1.0, -2.0, 2.0}), false), 3.0);
  EXPECT_THROW(distance(motion_of({0.0}), motion_of({0.0, 1.0}), false), std::logic_error);
}

TEST(WorkPrecision, RimsCountOnlyWhereAsked) {
  const Motion still = {{Place{}}}, turned = {{Place{Vec2::Zero(), 0.5}}};
  EXPECT_EQ(distance(still, turned, false).largest_m, 0.0);
  EXPECT_EQ(distance(still, turned, true).largest_m, 0.5);
}

TEST(WorkPrecision, JudgesRelativeToTheProblemsLength) {
  Problem problem;
  problem.frames = 2;
  problem.watched = {0};
  problem.exact = motion_of({0.0, 1.0, 2.0});
  problem.length_m = 2.0;
  Recording recording{motion_of({0.0, 1.1, 2.4}), 0.5, true};
  const Trial trial = judge(problem, recording);
  EXPECT_TRUE(trial.finite);
  EXPECT_NEAR(trial.error, 0.2, 1e-12);
  EXPECT_NEAR(trial.speed_m_s, 1.3 * 60.0, 1e-9);
  EXPECT_NEAR(trial.cpu_s_per_s, 15.0, 1e-12);
  recording.finite = false;
  EXPECT_FALSE(judge(problem, recording).finite);
}

TEST(WorkPrecision, CheapestMeetsTheErrorAtAllFinerSteps) {
  Problem problem;
  const std::vector<Rung> rungs{rung("a", 1, 1e-3, 1.0), rung("a", 2, 1e-1, 2.0),
                                rung("a", 4, 1e-4, 4.0), rung("b", 1, 5e-1, 0.5),
                                rung("b", 2, 1e-3, 3.0), rung("b", 4, 1e-5, 6.0)};
  EXPECT_EQ(cheapest(problem, rungs, 1e-2, false), 0) << "by luck";
  EXPECT_EQ(cheapest(problem, rungs, 1e-2, true), 4);
  EXPECT_EQ(cheapest(problem, rungs, 1e-4, true), 2);
  EXPECT_EQ(cheapest(problem, rungs, 1e-6, true), -1);
  EXPECT_EQ(cheapest(problem, rungs, 1.0, true), 3);
  problem.doubt_m = 1e-3;
  EXPECT_EQ(cheapest(problem, rungs, 1.5e-3, true), 2) << "the reference's doubt counts";
  EXPECT_EQ(cheapest(problem, rungs, 1e-3, true), -1);
}

TEST(WorkPrecision, TiesGoToTheFirstAndFailuresToNobody) {
  const Problem problem;
  EXPECT_EQ(cheapest(problem, {rung("a", 1, 0.0, 1.1), rung("b", 1, 0.0, 1.0)}, 1e-3, true), 0);
  EXPECT_EQ(cheapest(problem, {rung("a", 1, 0.0, 1.5), rung("b", 1, 0.0, 1.0)}, 1e-3, true), 1);
  EXPECT_EQ(cheapest(problem, {rung("a", 1, 0.0, 1.0), rung("a", 2, 0.0, 1.0, false)}, 1e-3, true),
            -1);
}

TEST(WorkPrecision, ADisturbedClockDoesNotAskForMoreSteps) {
  const Problem problem;
  const std::vector<Rung> rungs{rung("a", 1, 1e-1, 1.0), rung("a", 2, 1e-3, 9.0),
                                rung("a", 4, 1e-4, 2.0), rung("b", 1, 1e-3, 9.5)};
  EXPECT_EQ(cheapest(problem, rungs, 1e-2, true), 1);
  EXPECT_EQ(cheapest(problem, rungs, 1e-2, false), 2);
}

TEST(WorkPrecision, FrontHoldsWhatNothingBeats) {
  const std::vector<Rung> best =
      front({rung("a", 1, 1e-1, 1.0), rung("a", 2, 1e-3, 4.0), rung("b", 1, 1e-2, 2.0),
             rung("b", 2, 1e-2, 3.0), rung("b", 4, 0.0, 0.1, false)});
  ASSERT_EQ(best.size(), 3u);
  EXPECT_EQ(best[1].setting, "b");
  EXPECT_EQ(best[2].trial.error, 1e-3);
}

TEST(WorkPrecision, ObservedOrderOfAPowerLaw) {
  std::vector<Rung> rungs;
  for (int steps = 1; steps <= 16; steps *= 2) rungs.push_back(rung("a", steps, 0.1 / steps, 1.0));
  EXPECT_NEAR(observed_order(rungs, 1e-12), 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(observed_order(rungs, 0.04)));
}

TEST(WorkPrecision, LadderEndsWhereItGetsTooSlow) {
  const Problem problem = hanging_load();
  const auto run = [&](int steps) { return simulate(problem, Method::pinch, steps); };
  EXPECT_EQ(climb(problem, "a", run, 8, Limits{0.0, infinity}).size(), 4u);
  EXPECT_EQ(climb(problem, "a", run, 8, Limits{0.0, 0.0}).size(), 1u);
}

TEST(WorkPrecision, ContendersAreAllMethodsWithAllSolversAndTheThesis) {
  std::set<std::string> names;
  for (const Contender& contender : contenders()) names.insert(contender.name);
  EXPECT_EQ(names.size(), 7u);
  EXPECT_EQ(contenders().front().name, "pinch direct");
  EXPECT_EQ(contenders().back().name, "thesis");
}

// Where the discrete solution is the continuous one, one step a frame is exact.
TEST(WorkPrecision, DirectIsExactWhereTheAccelerationIsUniform) {
  for (const Problem& problem : {atwood(), slipping_atwood(), pulley_chain(), hanging_load()}) {
    const Trial trial = judge(problem, simulate(problem, Method::pinch, 1));
    EXPECT_TRUE(trial.finite);
    EXPECT_LT(trial.error, 1e-9) << problem.name;
  }
}

TEST(WorkPrecision, DirectKeepsTheStackAtRest) {
  const Problem problem = resting_stack();
  for (const int steps : {1, 4}) {
    const Trial trial = judge(problem, simulate(problem, Method::pinch, steps));
    EXPECT_LT(trial.error, 1e-6) << "of the half width";
    EXPECT_LT(trial.speed_m_s, 1e-9);
  }
}

TEST(WorkPrecision, DirectIsSecondOrderOnSmoothMotion) {
  for (const Problem& problem : {swinging_load(), roller_on_drum()}) {
    const auto run = [&](int steps) { return simulate(problem, Method::pinch, steps); };
    const std::vector<Rung> rungs = climb(problem, "pinch direct", run, 32, Limits{0.0, infinity});
    EXPECT_GT(observed_order(rungs, 1e-12), 1.9) << problem.name;
    EXPECT_LT(rungs.back().trial.error, 1e-6) << problem.name;
  }
}

TEST(WorkPrecision, AModelWithoutContactsIsWrongAtAnyStep) {
  const Problem problem = roller_on_drum();
  const Trial trial = judge(problem, simulate(problem, Method::pinch_no_contact, 64));
  EXPECT_GT(trial.error, 0.05);
}

TEST(WorkPrecision, OwnSolutionAgreesWithTheIndependentOne) {
  const Problem known = swinging_load();
  Problem own = own_solution("swing", known.scene, known.seconds(), 256);
  EXPECT_LT(own.doubt_m, 1e-6);
  own.watched = known.watched;
  Motion same_bodies;
  for (const auto& places : own.exact) same_bodies.push_back({places[0], places[1]});
  EXPECT_LT(distance(same_bodies, known.exact, false).largest_m, own.doubt_m);
}

}  // namespace
}  // namespace pinchlab::experiments
