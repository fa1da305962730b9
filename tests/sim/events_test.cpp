// SPDX-License-Identifier: GPL-3.0-or-later
// Events at their time: motion after them is as exact as before.

#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// A ball that falls on a wall, its lowest point from 0.9 m.
Scene falling_ball(double restitution, int steps_per_frame) {
  Scene scene;
  Body ball = body("ball", BodyKind::free, 0.0, 1.0, 0.1, 1.0);
  ball.restitution = restitution;
  scene.bodies.push_back(ball);
  scene.walls.push_back({Vec2(-5.0, 0.0), Vec2(5.0, 0.0), 0.5, 0.0});
  scene.steps_per_frame = steps_per_frame;
  return scene;
}

// A fall takes t0 = sqrt(2 h / g), and the k-th flight after it 2 e^k t0; height follows from it.
double height_of_bounces(double h, double g, double e, double t) {
  const double t0 = std::sqrt(2.0 * h / g);
  if (t < t0) return h - 0.5 * g * t * t;
  t -= t0;
  double speed = e * g * t0;
  while (t > 2.0 * speed / g) {
    t -= 2.0 * speed / g;
    speed *= e;
  }
  return speed * t - 0.5 * g * t * t;
}

TEST(Events, TenBouncesAreExactAtAnyStep) {
  for (const int steps : {1, 4, 16}) {
    const Scene scene = falling_ball(0.8, steps);
    World world = make_world(scene, measured());
    const double g = -scene.gravity.y(), t0 = std::sqrt(2.0 * 0.9 / g);
    double tenth = t0;  // time of the tenth bounce
    for (int k = 1; k < 10; ++k) tenth += 2.0 * std::pow(0.8, k) * t0;
    Workspace work;
    while (world.time() + world.step_length < tenth) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      const double exact = height_of_bounces(0.9, g, 0.8, world.time());
      ASSERT_NEAR(world.position[0].y() - 0.1, exact, 1e-8) << steps << ", t = " << world.time();
    }
    EXPECT_GE(world.diagnostics.events, 9);
  }
}

TEST(Events, ARestitutionOfOneKeepsTheEnergyBetweenTwoWalls) {
  Scene scene = falling_ball(1.0, 1);
  scene.gravity = Vec2::Zero();
  scene.bodies[0].velocity = {0.0, -7.3};
  scene.walls.push_back({Vec2(-5.0, 2.0), Vec2(5.0, 2.0), 0.5, 0.0});
  World world = make_world(scene, measured());
  run(scene, world, 600);
  EXPECT_NEAR(std::abs(world.velocity[0].y()), 7.3, 1e-12);
}

TEST(Events, NewtonsCradlePassesItsImpulseOn) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  for (int i = 0; i < 5; ++i) {
    Body ball =
        body(fmt::format("ball {}", i), BodyKind::free, i == 0 ? -1.0 : 0.2 * i, 0.0, 0.1, 1.0);
    ball.restitution = 1.0;
    ball.contact_friction = 0.0;
    if (i == 0) ball.velocity = {2.0, 0.0};
    scene.bodies.push_back(ball);
  }
  scene.steps_per_frame = 1;
  World world = make_world(scene, measured());
  run(scene, world, 60);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(world.velocity[i].norm(), 0.0, 1e-12) << i;
  EXPECT_NEAR(world.velocity[4].x(), 2.0, 1e-12);
}

// A weight m falls by the slack s and pulls M over a pulley without inertia: v = sqrt(2 g s)
// becomes v m / (m + M), and then both move with the acceleration g (m - M) / (m + M).
TEST(Events, ACatchIsExactAtAnyStep) {
  const double m = 3.0, M = 1.0, slack = 0.37;
  for (const int steps : {1, 4}) {
    Scene scene;
    Body pulley = body("pulley", BodyKind::fixed, 0.0, 0.0, 0.2, 1.0);
    pulley.cable_friction = 0.0;
    scene.bodies.push_back(pulley);
    scene.bodies.push_back(body("light", BodyKind::free, -0.25, -2.0, 0.05, M));
    scene.bodies.push_back(body("heavy", BodyKind::free, 0.25, -2.0, 0.05, m));
    scene.walls.push_back({Vec2(-1.0, -2.05), Vec2(0.0, -2.05), 0.5, 0.0});
    scene.cables.push_back(cable({1, Vec2::Zero()}, {{0, -1, 0}}, {2, Vec2::Zero()}));
    scene.cables[0].slack = slack;
    scene.steps_per_frame = steps;
    World world = make_world(scene, measured());
    const double g = 9.81, caught = std::sqrt(2.0 * slack / g), end = 0.5;
    run(scene, world, 30 * steps);
    const double speed = g * caught * m / (m + M), a = g * (m - M) / (m + M), t = end - caught;
    EXPECT_NEAR(world.position[2].y(), -2.0 - slack - speed * t - 0.5 * a * t * t, 1e-8) << steps;
  }
}

// Two bodies on either side of an elastic blow in the middle of the step: momentum and energy.
TEST(Events, ImpactsKeepMomentumAndEnergy) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  for (int i = 0; i < 2; ++i) {
    Body ball = body(i == 0 ? "a" : "b", BodyKind::free, i == 0 ? -1.0 : 1.0, 0.013 * i, 0.1,
                     i == 0 ? 1.0 : 2.5);
    ball.restitution = 1.0;
    ball.contact_friction = 0.0;
    ball.velocity = {i == 0 ? 3.1 : -1.7, 0.0};
    scene.bodies.push_back(ball);
  }
  World world = make_world(scene, measured());
  run(scene, world, 240);
  const Vec2 momentum = 1.0 * world.velocity[0] + 2.5 * world.velocity[1];
  EXPECT_NEAR(momentum.x(), 3.1 - 2.5 * 1.7, 1e-12);
  EXPECT_NEAR(momentum.y(), 0.0, 1e-12);
  const double energy =
      0.5 * world.velocity[0].squaredNorm() + 1.25 * world.velocity[1].squaredNorm();
  EXPECT_NEAR(energy, 0.5 * 3.1 * 3.1 + 1.25 * 1.7 * 1.7, 1e-11);
  EXPECT_EQ(world.diagnostics.events, 1);
}

// A bob that is let go inward more slowly than its way bends back outward is on its cable all the
// time. At the start the cable bears nothing, and J v is above 0.
TEST(Events, AWayThatBendsBackIsHeldWithoutDividingTheStep) {
  for (const int steps : {1, 4, 16}) {
    for (const double inward : {0.2, 0.6, 0.8, 0.95}) {  // of what the way bends outward by
      Scene scene;
      scene.gravity = Vec2::Zero();
      scene.steps_per_frame = steps;
      scene.bodies.push_back(body("bob", BodyKind::free, 1.0, 0.0, 0.1, 1.0));
      const double v = 2.0, h = 1.0 / (60.0 * steps);
      scene.bodies[0].velocity = {-inward * 0.5 * h * v * v, v};
      scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0)));
      World world = make_world(scene, measured());
      world.cables[0].segments[1].slack = true;
      Workspace work;
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      EXPECT_EQ(world.diagnostics.intervals, 1) << steps << " " << inward;
      EXPECT_NEAR(world.position[0].norm(), 1.0, 1e-11);
    }
  }
}

TEST(Events, AreLocatedByTheDirectSolverOnExactLengths) {
  Configuration exact;
  EXPECT_TRUE(locates_events(exact));
  exact.solver = Solver::iterative;
  EXPECT_FALSE(locates_events(exact));
  EXPECT_FALSE(locates_events(thesis_configuration()));
  EXPECT_FALSE(locates_events(Method::cable));
}

}  // namespace
}  // namespace pinchlab::testing
