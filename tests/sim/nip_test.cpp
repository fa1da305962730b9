// SPDX-License-Identifier: GPL-3.0-or-later
// Pinches between bodies that cannot give way along the cable, blows on pinches, and slack cable in
// a straight nip.

#include <tuple>
#include <utility>

#include "sim/joints.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double drum = 0.3, roller = 0.1, half_width = 0.02, rim = drum + half_width;  // m

/// A smooth fixed drum, a roller on it on an upright rail, and a cable between with two weights.
Scene under_roller(double mass, double friction, double left, double right) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed, 0.0, 0.0, drum));
  scene.bodies.push_back(
      body("roller", BodyKind::rail, 0.0, rim + half_width + roller, roller, mass));
  scene.bodies.push_back(body("left", BodyKind::free, -rim, -1.0, 0.1, left));
  scene.bodies.push_back(body("right", BodyKind::free, rim, -1.0, 0.1, right));
  scene.bodies[0].cable_friction = 0.0;
  scene.bodies[1].cable_friction = friction;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(3), half_width));
  return scene;
}

/// A roll of 0.1 m on an axle, and one of 0.15 m and 4 kg that gravity presses against it on a
/// level rail; an upright cable between them, which nothing wraps.
Scene nip(double of_axle, double of_rail) {
  Scene scene;
  scene.gravity = {-5.0, 0.0};
  scene.bodies.push_back(body("on axle", BodyKind::fixed_axle, -0.12, 0.0, 0.1, 1.0));
  scene.bodies.push_back(body("on rail", BodyKind::rail, 0.17, 0.0, 0.15, 4.0));
  scene.bodies[1].rail_axis = {1.0, 0.0};
  scene.bodies[0].cable_friction = of_axle;
  scene.bodies[1].cable_friction = of_rail;
  return scene;
}

class Nip : public ::testing::TestWithParam<int> {};

// A driven wringer drags a stretched cable to and fro: each kick that it gives the roller above is
// within its friction, mu N. Where the states went round in circles the cable was glued to both for
// a step, and the roller came up to the driven one's 2 rad/s at once.
TEST_P(Nip, AnElasticCableTurnsItsRollerNoHarderThanItRubs) {
  constexpr double mu = 0.1, radius = 0.2, mass = 20.0;
  Scene scene;
  scene.bodies.push_back(body("lower", BodyKind::fixed_axle, 0.0, 0.0, radius, 2.0));
  scene.bodies.push_back(
      body("upper", BodyKind::rail, 0.0, 2.0 * (radius + half_width), radius, mass));
  for (Body& roll : scene.bodies) roll.cable_friction = mu;
  scene.bodies[0].driven_angular_velocity = -2.0;
  scene.cables.push_back(cable(at(-1.0, -0.2), {{0, -1, 0}}, at(1.0, -0.2), half_width));
  scene.cables[0].axial_stiffness = 5000.0;
  scene.cables[0].slack = -0.005;
  scene.steps_per_frame = GetParam();
  World world = make_world(scene, measured());
  const double torque = mu * mass * g * (radius + half_width);
  // Kicks of a step's intervals last up to one step and a half.
  const double most = 1.5 * torque / (0.5 * mass * radius * radius) * world.step_length;
  Workspace work;
  double speed = 0.0, fastest = 0.0;
  for (int i = 0; i < 30 * GetParam(); ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    EXPECT_LT(std::abs(world.angular_velocity[1] - speed), most * (1.0 + 1e-9)) << i;
    speed = world.angular_velocity[1];
    fastest = std::max(fastest, std::abs(speed));
  }
  EXPECT_EQ(world.diagnostics.fallbacks, 0);
  EXPECT_GT(fastest, 0.05);
  EXPECT_LT(fastest, 0.4);
}

/// A load after 0.6 s that a drum hauls up by an elastic rope, on which a roller presses the rope,
/// with a weight at its tail.
World feed(double mu, double pressing, double stiffness, double load, int steps_per_frame) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.2, 3.0));
  scene.bodies.push_back(body("nip", BodyKind::rail, 0.0, 0.32, 0.1, pressing));
  scene.bodies.push_back(body("load", BodyKind::rail, -0.21, -2.0, 0.05, load));
  scene.bodies.push_back(body("tail", BodyKind::rail, 0.21, -1.0, 0.05, 1.0));
  scene.bodies[0].driven_angular_velocity = -3.0;
  scene.bodies[0].torque_limit = 30.0;
  scene.bodies[0].cable_friction = scene.bodies[1].cable_friction = mu;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(3), 0.01));
  scene.cables[0].axial_stiffness = stiffness;
  return after(scene, steps_per_frame, 0.6);
}

// Loads that swing on ropes which slip, roll and stick by turns: where the rope was glued for a
// step, or the curvature foreseen of a roller on cable that slides was all that it slides by, they
// ended up to 0.1 m apart.
TEST(ElasticNip, WhatIsFedEndsAlikeAtAnyStep) {
  struct Case {
    double mu, pressing, stiffness, load;
  };
  for (const Case& c : {Case{0.1, 20.0, 3e3, 4.0}, Case{0.1, 20.0, 2e4, 4.0},
                        Case{0.3, 5.0, 2e4, 4.0}, Case{0.3, 20.0, 3e3, 12.0}}) {
    const World fine = feed(c.mu, c.pressing, c.stiffness, c.load, 32);
    EXPECT_EQ(fine.diagnostics.fallbacks, 0) << c.mu << ' ' << c.stiffness;
    for (const auto& [steps, most] : {std::pair(1, 8e-3), {4, 3e-3}}) {
      const World world = feed(c.mu, c.pressing, c.stiffness, c.load, steps);
      EXPECT_EQ(world.diagnostics.fallbacks, 0) << c.mu << ' ' << c.stiffness << ' ' << steps;
      EXPECT_NEAR(world.position[2].y(), fine.position[2].y(), most)
          << c.mu << ' ' << c.stiffness << ' ' << steps;
    }
  }
}

// A weight pulls an elastic rope, slack above, through a nip: over a disc that stands, which holds
// mu N = 30 N, under a roller that it spins. With u of the rope, u' = (T - 30) / (I / p^2) while u
// > 0, integrated in steps of 1e-6 s: the weight comes to -1.11862 m. It is the same whether the
// cable wraps the roller or is only pressed by it, where all that was stretched was let go at once.
TEST(ElasticNip, AWeightPullsSlackRopeThrough) {
  Scene scene;
  scene.bodies.push_back(body("disc", BodyKind::fixed, -0.11, 0.0, 0.1));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.11, 0.0, 0.1, 1.0));
  scene.bodies.push_back(body("weight", BodyKind::rail, 0.0, -1.0, 0.08, 2.0));
  scene.bodies.push_back(body("top", BodyKind::rail, 0.0, 4.0, 0.08, 0.5));
  scene.bodies[1].rail_axis = {1.0, 0.0};
  scene.bodies[3].linear_drag = 8.0;
  scene.bodies[0].cable_friction = scene.bodies[1].cable_friction = 0.3;
  add_spring(scene, "spring", {-1, {1.11, 0.0}}, on(1), 1000.0, 1.1, 0.0);
  scene.cables.push_back(cable(on(3), {{0, -1, 0}}, on(2), 0.01));
  scene.cables.back().axial_stiffness = 300.0;
  Scene wrapped = scene;
  wrapped.cables.back().wraps.push_back({1, 1, 0});
  for (const auto& [steps, most] : {std::pair(1, 2e-3), {4, 2e-4}, {16, 2e-5}}) {
    const World world = after(scene, steps, 59.0 / 60.0);
    EXPECT_NEAR(world.position[2].y(), -1.11862, most) << steps;
    EXPECT_EQ(world.diagnostics.fallbacks, 0) << steps;
    EXPECT_NEAR(after(wrapped, steps, 59.0 / 60.0).position[2].y(), world.position[2].y(), 1e-9)
        << steps;
  }
}

// Neither a driven roller on a rail that is straight at the drum nor a drum that stands gives way
// along the cable: the friction of the roller was none.
TEST_P(Nip, ARollerThatDoesNotTurnHoldsTheCable) {
  Scene scene = under_roller(3.0, 0.9, 1.0, 1.2);
  scene.bodies[1].driven_angular_velocity = 0.0;
  EXPECT_NEAR(after(scene, GetParam(), 0.5).position[3].y(), -1.0, 1e-12);
}

// It slides at first: mu m g less the difference of the weights moves both.
TEST_P(Nip, ADrivenRollerLifts) {
  Scene scene = under_roller(3.0, 0.5, 1.0, 1.2);
  scene.bodies[1].driven_angular_velocity = -2.0;
  const double speed = 2.0 * (roller + half_width);
  const double acceleration = (0.5 * 3.0 - 0.2) * g / 2.2;
  const double lifted = speed * 0.5 - 0.5 * speed * speed / acceleration;
  EXPECT_NEAR(after(scene, GetParam(), 0.5).position[3].y(), -1.0 + lifted, 1e-9);
}

// The friction of both bodies counts: 16 N of the driven one against 4 N of the other and a weight,
// until the cable is as fast as the rim.
TEST_P(Nip, BothBodiesRub) {
  Scene scene = nip(0.2, 0.8);
  scene.gravity.y() = -g;
  scene.bodies[0].kind = BodyKind::fixed;
  scene.bodies[1].driven_angular_velocity = -2.0;
  scene.bodies.push_back(body("weight", BodyKind::rail, 0.0, -1.0, 0.1, 1.0));
  scene.cables.push_back(cable(at(0.0, 1.0), {}, on(2), half_width));
  scene.steps_per_frame = GetParam();
  World world = make_world(scene, measured());
  std::vector<double> height;
  for (const double time : {0.05, 0.1, 0.15, 0.4, 0.5}) {
    run_to(scene, world, time);
    height.push_back(world.position[2].y());
  }
  EXPECT_NEAR(height[0] - 2.0 * height[1] + height[2], (16.0 - 4.0 - g) * 0.05 * 0.05, 1e-9);
  EXPECT_NEAR(height[4] - height[3], 0.1 * 2.0 * (0.15 + half_width), 1e-9);
}

// A ball of 3 kg lands on the roller with 2 m/s, while cable slides below it at 6 m/s, without
// tension: the weight that pulls it is slower by 0.3 times the blow afterwards. That was left out
// where the drum is smooth, or not, by round-off of the heights.
TEST_P(Nip, ABlowRubsOnWhatSlidesOverASmoothDrum) {
  for (int k = 0; k < 8; ++k) {
    Scene scene = under_roller(2.0, 0.3, 1.0, 1.0);
    scene.gravity = Vec2::Zero();
    scene.bodies[1].inertia = 1e4;
    scene.bodies[2].velocity = {0.0, 6.0};
    scene.bodies[3].velocity = {0.0, -6.0};
    const double start = rim + half_width + 2.0 * roller + 0.1;  // m, where they touch
    const double fall = 0.05 + 0.01 * k;
    scene.bodies.push_back(body("ball", BodyKind::free, 0.0, start + fall, 0.1, 3.0));
    scene.bodies[4].velocity = {0.0, -2.0};
    scene.bodies[1].contact_friction = scene.bodies[4].contact_friction = 0.0;
    const double y = after(scene, GetParam(), 0.1).position[3].y();
    EXPECT_NEAR(y, -1.0 - 6.0 * 0.1 + 0.3 * 6.0 * (0.1 - 0.5 * fall), 2e-6) << fall;
  }
}

// Where the other weight's slack is caught the cable stays with the roller, which has no slip.
TEST_P(Nip, WhatIsCaughtStaysWithARollerWithoutSlip) {
  Scene scene = under_roller(1.34, infinity, 1.0, 1.0);
  scene.bodies[0].kind = BodyKind::fixed_axle;
  scene.bodies[1].driven_angular_velocity = 2.0;
  const World world = after(scene, GetParam(), 0.5);
  EXPECT_NEAR(world.position[2].y(), -1.0 + 0.12, 1e-9);
  EXPECT_NEAR(world.position[3].y(), -1.0 - 0.12, 1e-9);
}

// Slack cable goes with the roll that holds it more, on which side of it that may be: it always
// stayed with the one on the rail.
TEST_P(Nip, SlackCableGoesWithWhatHoldsItMore) {
  for (const auto& [of_axle, of_rail] :
       {std::tuple{infinity, 0.0}, {0.3, 0.1}, {0.1, 0.3}, {0.0, infinity}}) {
    for (const int driven : {0, 1}) {
      Scene scene = nip(of_axle, of_rail);
      scene.bodies[0].driven_angular_velocity = driven == 0 ? 3.0 : 0.0;
      scene.bodies[1].driven_angular_velocity = driven == 1 ? -2.0 : 0.0;
      scene.cables.push_back(cable(at(0.0, 2.0), {}, at(0.0, -2.0), half_width));
      scene.cables[0].slack = 1.0;
      const int holds = of_axle > of_rail ? 0 : 1;
      const double fed = holds != driven ? 0.0 : 0.4 * (driven == 0 ? 3.0 * 0.12 : 2.0 * 0.17);
      scene.steps_per_frame = GetParam();
      World world = make_world(scene, measured());
      run_to(scene, world, 0.1);
      const double before = world.cables[0].segments[1].rest_length;
      run_to(scene, world, 0.5);
      EXPECT_NEAR(world.cables[0].segments[1].rest_length - before, fed, 1e-12)
          << of_axle << " " << of_rail << " " << driven;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pinch, Nip, ::testing::Values(1, 4, 16));

}  // namespace
}  // namespace pinchlab::testing
