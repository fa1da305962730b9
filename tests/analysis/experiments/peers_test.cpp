// SPDX-License-Identifier: GPL-3.0-or-later
// The physics of the other engines' models, where those are installed.

#include "analysis/experiments/peers/peer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "analysis/experiments/accuracy_scenes.h"
#include "analysis/experiments/event_scenes.h"

namespace pinchlab::experiments {
namespace {

Peer peer_called(const std::string& name) {
  for (const Peer& peer : peers()) {
    if (peer.name == name) return peer;
  }
  return {};
}

/// Least error of all settings at `steps` a frame.
double best_error(const Peer& peer, const Problem& problem, int steps) {
  double best = infinity;
  for (const PeerSetting& setting : peer.settings(problem, true)) {
    const Trial trial = judge(problem, setting.run(problem, steps));
    if (trial.finite) best = std::min(best, trial.error);
  }
  return best;
}

TEST(Peers, AreToldApart) {
  EXPECT_EQ(peers().size(), 2u);
  for (const Peer& peer : peers()) {
    EXPECT_FALSE(peer.package.empty());
    EXPECT_FALSE(peer.model.empty());
    EXPECT_EQ(peer.present(), static_cast<bool>(peer.settings)) << peer.name;
  }
}

TEST(Peers, Box2dChainHoldsItsLoadOnceStepsAreManyEnough) {
  const Peer peer = peer_called("Box2D");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  const Problem hanging = hanging_load();
  EXPECT_GT(best_error(peer, hanging, 1), 1e-2);
  EXPECT_LT(best_error(peer, hanging, 64), 1e-3);
  EXPECT_LT(best_error(peer, atwood(), 64), 0.05);
  EXPECT_LT(best_error(peer, slipping_atwood(), 64), 0.05);
}

TEST(Peers, Box2dSaysWhatIsNotBuilt) {
  const Peer peer = peer_called("Box2D");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  Problem problem = atwood();
  EXPECT_EQ(peer.cannot(problem), "");
  problem.scene.cables[0].closed = true;
  EXPECT_NE(peer.cannot(problem).find("closed"), std::string::npos);
  problem = atwood();
  problem.scene.bodies[2].driven_angular_velocity = 1.0;
  EXPECT_NE(peer.cannot(problem).find("drives"), std::string::npos);
}

Problem finely_solved(const std::string& name) {
  for (Problem& problem : finely_solved_problems(1024)) {
    if (problem.name == name) return problem;
  }
  return {};
}

Problem known(const std::string& name) {
  for (Problem& problem : known_problems()) {
    if (problem.name == name) return problem;
  }
  return {};
}

TEST(Peers, Box2dNodesHangAndFallOnceStepsAreManyEnough) {
  const Peer peer = peer_called("Box2D");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  EXPECT_LT(best_error(peer, known("hanging-cable"), 64), 1e-5);
  const Problem fold = finely_solved("folded-chain");
  EXPECT_GT(best_error(peer, fold, 4), 0.1);
  EXPECT_LT(best_error(peer, fold, 256), 0.02);
}

TEST(Peers, Box2dLinksRunRoundCorners) {
  const Peer peer = peer_called("Box2D");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  EXPECT_LT(best_error(peer, known("square-unwinding"), 64), 0.02);
}

// Another program, other coordinates, a method of fourth order: it comes to where our own solution
// does.
TEST(Peers, MujocoLinksAgreeThatAFoldedChainFallsLikeThis) {
  const Peer peer = peer_called("MuJoCo");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  EXPECT_LT(best_error(peer, finely_solved("folded-chain"), 64), 2e-6);
  EXPECT_LT(best_error(peer, known("hanging-cable"), 4), 1e-7);
}

TEST(Peers, EventScenesTakeWhoCan) {
  const Peer box2d = peer_called("Box2D"), mujoco = peer_called("MuJoCo");
  for (const Problem& problem : event_problems()) {
    const std::vector<Cable>& cables = problem.scene.cables;
    const bool slack = !cables.empty() && cables[0].slack > 0.0;
    const bool driven = std::ranges::any_of(problem.scene.bodies, [](const Body& body) {
      return body.driven_angular_velocity.has_value();
    });
    if (box2d.present()) {
      EXPECT_EQ(box2d.cannot(problem), slack    ? "slack cables are not built"
                                       : driven ? "drives, torques and drag are not built"
                                                : "");
    }
    if (mujoco.present()) {
      EXPECT_NE(mujoco.cannot(problem), "") << problem.name;
    }
  }
}

TEST(Peers, Box2dBallsRebound) {
  const Peer peer = peer_called("Box2D");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  EXPECT_LT(best_error(peer, bouncing_ball(), 256), 0.02);
  EXPECT_LT(best_error(peer, ball_between_walls(), 256), 0.05);
}

TEST(Peers, MujocoTendonIsSecondOrderWhenStartedHalfAStepBack) {
  const Peer peer = peer_called("MuJoCo");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  const Problem problem = swinging_load();
  std::vector<double> orders;
  for (const PeerSetting& setting : peer.settings(problem, true)) {
    const auto run = [&](int steps) { return setting.run(problem, steps); };
    orders.push_back(
        observed_order(climb(problem, setting.text, run, 32, Limits{0.0, infinity}), 1e-9));
  }
  ASSERT_EQ(orders.size(), 3u);
  EXPECT_NEAR(orders[0], 1.0, 0.1) << "semi-implicit Euler";
  EXPECT_GT(orders[1], 1.9) << "as a leapfrog";
}

TEST(Peers, MujocoTendonCarriesPulleysAsArmature) {
  const Peer peer = peer_called("MuJoCo");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  EXPECT_LT(best_error(peer, atwood(), 1), 1e-5);
  EXPECT_LT(best_error(peer, pulley_chain(), 4), 1e-4);
}

TEST(Peers, MujocoSaysWhatATendonCannotDo) {
  const Peer peer = peer_called("MuJoCo");
  if (!peer.present()) GTEST_SKIP() << peer.package << " was not installed";
  EXPECT_EQ(peer.cannot(atwood()), "");
  EXPECT_NE(peer.cannot(slipping_atwood()).find("friction"), std::string::npos);
  Problem fixed = atwood();
  fixed.scene.bodies[2].kind = BodyKind::fixed;
  EXPECT_NE(peer.cannot(fixed).find("friction"), std::string::npos);
  fixed.scene.bodies[2].cable_friction = 0.0;
  EXPECT_EQ(peer.cannot(fixed), "");
  EXPECT_NE(peer.cannot(roller_on_drum()).find("pinched"), std::string::npos);
  EXPECT_NE(peer.cannot(resting_stack()).find("pinched"), std::string::npos);
  EXPECT_NE(peer.cannot(known("square-unwinding")).find("corners"), std::string::npos);
  EXPECT_NE(peer.cannot(known("rope-atwood")).find("no mass"), std::string::npos);
}

}  // namespace
}  // namespace pinchlab::experiments
