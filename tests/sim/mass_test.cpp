// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass that run over bodies.

#include "sim/cable/mass.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "demos/scenes/shape_scenes.h"
#include "sim/diagnostics.h"
#include "sim/make_world.h"
#include "sim/outline.h"
#include "sim/promises.h"
#include "tests/sim/course.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

// x'' = (dm g + 2 rho g x) / (m1 + m2 + rho L + I / R^2), a motion A (cosh k t - 1). What is left
// is Numerov's error of it, A sinh(k t) k t (k h)^4 / 480.
TEST(Mass, ARopeOverAPulleyFallsAsItsWeightMovesOver) {
  const double k = std::sqrt(0.8 * g / 4.35);
  for (const int steps : {1, 2, 4, 8, 16}) {
    const Scene scene = build::rope_atwood(steps);
    World world = make_world(scene, measured());
    const double from = world.position[1].y(), kh = k / (60.0 * steps);
    for (const double stated : {0.14632628, 0.65382154}) {
      run(scene, world, 30 * steps);
      const double kt = k * world.time();
      const double exact = 0.625 * (std::cosh(kt) - 1.0);
      const double own = 0.625 * std::sinh(kt) * kt * std::pow(kh, 4) / 480.0;
      EXPECT_NEAR(exact, stated, 5e-9);
      EXPECT_NEAR(from - world.position[1].y(), exact, 1.1 * own + 1e-12) << steps;
      EXPECT_NEAR(world.position[0].y() + world.position[1].y(), 2.0 * from, 1e-12);
    }
  }
}

// A belt is set going by a torque: I1 + I2 (R1 / R2)^2 + rho L R1^2 of the first pulley.
TEST(Mass, ABeltTurnsWithItsRims) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies.push_back(body("first", BodyKind::fixed_axle, 0.0, 0.0, 0.3));
  scene.bodies.push_back(body("second", BodyKind::fixed_axle, 1.2, 0.5, 0.14));
  scene.bodies[0].inertia = 0.2;
  scene.bodies[1].inertia = 0.05;
  scene.bodies[0].torque = 1.5;
  Cable belt = cable({}, {{0, 1, 0}, {1, 1, 0}}, {}, 0.01);
  belt.closed = true;
  belt.mass_per_metre = 0.7;
  scene.cables.push_back(belt);
  World world = make_world(scene, Method::pinch);
  run(scene, world, 240);
  const double ratio = 0.31 / 0.15;
  const double inertia = 0.2 + 0.05 * ratio * ratio + 0.7 * world.cables[0].length * 0.31 * 0.31;
  EXPECT_NEAR(world.angle[0], 0.5 * 1.5 / inertia, 1e-12);
  EXPECT_NEAR(world.angle[1], ratio * world.angle[0], 1e-12);
}

// The same on a motor with a limited torque, which cannot hold its speed at once.
TEST(Mass, AMotorWithALimitBearsTheRope) {
  Scene scene = build::rope_atwood(4);
  scene.bodies[2].driven_angular_velocity = 50.0;
  scene.bodies[2].torque_limit = 4.0;
  World world = make_world(scene, Method::pinch);
  const double from = world.position[0].y();
  run(scene, world, 24);
  // Its pull at the rope's 0.2 m, with the lighter weight against the heavier one.
  const double k = std::sqrt(0.8 * g / 4.35), start = (4.0 / 0.2 - 0.5 * g) / 4.35;
  const double expected = start / (k * k) * (std::cosh(0.1 * k) - 1.0);
  EXPECT_NEAR(from - world.position[0].y(), expected, 1e-5 * expected);
}

/// A bob of 0.5 kg on a rope of 0.25 kg that a drum winds up as it swings, or lets it turn.
Scene swinging_bob(int steps) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("bob", BodyKind::free, 1.0, -0.6, 0.05, 0.5));
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.19));
  scene.bodies[1].inertia = 0.2;
  scene.cables.push_back(cable({1, {-0.2, 0.0}}, {{1, -1, 0}}, on(0), 0.01));
  scene.cables[0].mass_per_metre = 0.5;
  return scene;
}

/// A square instead of the pulley.
Scene swinging_square(int steps) {
  Scene scene = build::heavy_tackle(steps);
  make_polygon(scene.bodies[2], {{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}, 0.02);
  scene.bodies[2].inertia = 0.1;
  return scene;
}

// A rope that has more of it than its way over two wheels, none of it taut: what falls with the
// weight, and turns the wheels, is what its weight lies over on either side.
Scene loose_rope(int steps) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies = {body("near", BodyKind::fixed_axle, 0.0, 0.0, 0.36, 0.5),
                  body("far", BodyKind::fixed_axle, 1.5, -0.15, 0.36, 0.5),
                  body("weight", BodyKind::free, 1.95, -1.0, 0.1, 5.0)};
  scene.cables = {cable({-1, {-1.0, -1.5}}, {{0, -1, 0}, {1, -1, 0}}, {2, Vec2::Zero()}, 0.02)};
  scene.cables[0].slack = 0.3;
  scene.cables[0].mass_per_metre = 0.5;
  return scene;
}

// And one that is hundreds of times as heavy as what hangs on it.
Scene heavy_loose_rope(int steps) {
  Scene scene = loose_rope(steps);
  scene.bodies[2].mass = 0.005;
  return scene;
}

// Motion and energy, against a much shorter step and against the start.
TEST(Mass, SwingsOnSecondOrderAndKeepsItsEnergy) {
  struct Case {
    Scene (*make)(int);
    double seconds;
  };
  for (const auto& [make, seconds] :
       {Case{swinging_bob, 0.4}, Case{build::heavy_tackle, 0.4}, Case{swinging_square, 0.15},
        Case{loose_rope, 0.1}, Case{heavy_loose_rope, 0.1}}) {
    const Course exact = run_measured(make(128), seconds);
    double error = 0.0, energy = 0.0;
    for (const int steps : {2, 4, 8, 16}) {
      const Course course = run_measured(make(steps), seconds);
      const double now = largest_difference(course.end, exact.end);
      if (error > 0.0) {
        EXPECT_GT(error / now, 3.5) << steps;
      }
      if (energy > 0.0) {
        EXPECT_GT(energy / course.energy, 3.4) << steps;
      }
      error = now;
      energy = course.energy;
    }
    EXPECT_LT(error, 1e-5);
    EXPECT_LT(energy, 1e-4);
  }
}

// A side of the square comes to lie on the rope between two steps' starts: a blow, without rebound.
TEST(Mass, ASideThatMeetsTheRopeTakesEnergy) {
  const Course before = run_measured(swinging_square(16), 0.15);
  const Course after = run_measured(swinging_square(16), 0.3);
  EXPECT_LT(before.energy, 2e-5);
  EXPECT_GT(after.energy, 1e-3);
  EXPECT_LT(after.gained, 2e-5);
}

// On a drum of radius R that turns at W a bob m swings on l = l0 + R (a - a0 - W t) of rope by
//     d/dt ((m + rho l / 2) l^2 a') = R (m + 3/4 rho l) l a'^2 + (m + rho l / 2) l g . n,
// from T = (m + rho l / 2) (l a')^2 / 2 + const: by the method of Runge and Kutta.
TEST(Mass, AWinchedPendulumSwingsByLagrangesEquation) {
  constexpr double radius = 0.2, mass = 0.5, rho = 0.6;  // m, kg, kg/m
  for (const double turning : {-3.0, 3.0}) {
    Scene scene = swinging_bob(64);
    scene.cables[0].mass_per_metre = rho;
    scene.bodies[1].driven_angular_velocity = turning;
    World world = make_world(scene, Method::pinch);
    const Segment& span = world.cables[0].segments.back();
    const Vec2 direction = span.direction;
    scene.bodies[0].velocity = -radius * turning * direction;
    world = make_world(scene, Method::pinch);
    const double from = world.cables[0].segments.back().length;
    const double first = std::atan2(direction.y(), direction.x());
    const auto length = [&](double a, double t) {
      return from + radius * (a - first - turning * t);
    };
    const auto slope = [&](double t, double a, double p, double& a_dot, double& p_dot) {
      const double l = length(a, t), all = mass + 0.5 * rho * l;
      a_dot = p / (all * l * l);
      p_dot = radius * (mass + 0.75 * rho * l) * l * a_dot * a_dot - all * l * g * std::cos(a);
    };
    double a = first, p = 0.0;
    constexpr int count = 4000;
    constexpr double h = 0.5 / count;
    for (int i = 0; i < count; ++i) {
      double da[4], dp[4];
      const double t = i * h;
      slope(t, a, p, da[0], dp[0]);
      slope(t + 0.5 * h, a + 0.5 * h * da[0], p + 0.5 * h * dp[0], da[1], dp[1]);
      slope(t + 0.5 * h, a + 0.5 * h * da[1], p + 0.5 * h * dp[1], da[2], dp[2]);
      slope(t + h, a + h * da[2], p + h * dp[2], da[3], dp[3]);
      a += h / 6.0 * (da[0] + 2.0 * da[1] + 2.0 * da[2] + da[3]);
      p += h / 6.0 * (dp[0] + 2.0 * dp[1] + 2.0 * dp[2] + dp[3]);
    }
    run(scene, world, 30 * 64);
    const double l = length(a, 0.5);
    EXPECT_NEAR(world.cables[0].segments.back().length, l, 2e-6) << turning;
    const Vec2 e(std::cos(a), std::sin(a)), n(-std::sin(a), std::cos(a));
    EXPECT_LT((world.position[0] - (radius * n + l * e)).norm(), 5e-6) << turning;
  }
}

/// Linear momentum of all, less what gravity has given (N s).
Vec2 momentum_of(const Scene& scene, const World& world) {
  Workspace work;
  const Velocities now = velocities_now(scene, world, work);
  std::vector<Eigen::Matrix3d> carried;
  std::vector<Sleeve> sleeves;
  find_carried(world, carried, sleeves);
  Vec2 sum = Vec2::Zero();
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Eigen::Vector3d v(now.linear[b].x(), now.linear[b].y(), now.angular[b]);
    const double mass = world.bodies[b].mass;
    sum += mass * v.head<2>() + (carried[b] * v).head<2>();
    sum -= (mass + carried[b](0, 0)) * world.time() * scene.gravity;
  }
  return sum;
}

/// Two bodies that a belt joins, in free flight, and a third one that runs into it; or leaves it.
Scene flying_belt(bool leaves, int steps) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("first", BodyKind::free, -0.6, 0.0, 0.2, 1.0));
  scene.bodies.push_back(body("second", BodyKind::free, 0.6, 0.1, 0.25, 2.0));
  scene.bodies.push_back(body("third", BodyKind::free, 0.0, leaves ? 0.36 : 0.6, 0.1, 0.5));
  scene.bodies[0].angular_velocity = 2.0;
  scene.bodies[1].velocity = {0.4, 0.3};
  scene.bodies[2].velocity = {0.2, leaves ? 1.0 : -3.0};
  Cable belt = cable({}, {{0, 1, 0}, {1, 1, 0}}, {}, 0.01);
  if (leaves) belt.wraps.push_back({2, -1, 0});
  belt.closed = true;
  belt.slack = 0.02;
  belt.mass_per_metre = 0.9;
  scene.cables.push_back(belt);
  return scene;
}

// A body takes up its share of the belt when it comes, and hands it back when it goes.
TEST(Mass, MomentumIsKeptWhoeverJoinsTheCable) {
  for (const bool leaves : {false, true}) {
    double error = 0.0;
    for (const int steps : {4, 16, 64}) {
      const Scene scene = flying_belt(leaves, steps);
      World world = make_world(scene, Method::pinch);
      Workspace work;
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      const Vec2 first = momentum_of(scene, world);
      ASSERT_EQ(world.cables[0].links.size(), leaves ? 3U : 2U);
      double most = 0.0;
      for (int i = 0; i < 12 * steps; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
        most = std::max(most, (momentum_of(scene, world) - first).norm());
      }
      EXPECT_EQ(world.cables[0].links.size(), leaves ? 2U : 3U) << steps;
      if (error > 0.0) {
        EXPECT_GT(error / most, 8.0) << steps;
      }
      error = most;
    }
  }
}

// What the energy of the mean of two velocities swings by falls with the square of the step. In a
// motion cosh k t of leapfrog that mean is k (1 + (k h)^2 / 8) of the place, and (k h)^2 / 6 more
// than k where, by Numerov's method, the motion itself errs by its fourth power only. Elastic
// cables over rims have an error of their own (sim/README.md, "Limits").
TEST(RandomMass, StayFiniteAndMakeNoEnergy) {
  EXPECT_GT(run_heavy_ropes(falling_on_rope, 300), seeds_of(500));
}

TEST(RandomMass, AClearedWorkspaceChangesNoBit) {
  for (unsigned seed = 0; seed < seeds_of(40U); ++seed) {
    const Scene scene = falling_on_rope(seed);
    EXPECT_TRUE(is_all_state(scene, Method::pinch, 200)) << seed;
  }
}

// A rope that would hang is told of.
TEST(Mass, WhatWouldHangBreaksAPromise) {
  for (const double weight : {0.01, 5.0}) {
    Scene scene;
    scene.bodies.push_back(body("weight", BodyKind::free, 2.2, -0.5, 0.1, weight));
    scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 2.0, 0.0, 0.19));
    scene.cables.push_back(cable(at(0.0, 0.2), {{1, -1, 0}}, on(0), 0.01));
    scene.cables[0].mass_per_metre = 0.5;
    World world = make_world(scene, Method::pinch);
    Promises promises(scene, world);
    Workspace work;
    for (int i = 0; i < 8; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      promises.note(scene, world);
    }
    const std::vector<std::string> broken = promises.broken(scene, world);
    ASSERT_EQ(broken.size(), weight < 1.0 ? 1U : 0U);
    if (weight < 1.0) {
      EXPECT_NE(broken[0].find("would have hung"), std::string::npos) << broken[0];
    }
  }
}

// A disc that leaves the rope has its own mass again, though a slack string to the weight keeps it
// in the part: the string's catch must not know of the rope.
TEST(Mass, WhoLeavesTheCableIsRidOfIt) {
  Scene scene;
  scene.bodies.push_back(body("weight", BodyKind::free, 1.42, -1.0, 0.1, 2.0));
  scene.bodies.push_back(body("disc", BodyKind::free, 0.6, 0.285, 0.1, 0.5));
  scene.bodies.push_back(body("left", BodyKind::fixed_axle, 0.0, 0.0, 0.2));
  scene.bodies.push_back(body("right", BodyKind::fixed_axle, 1.2, 0.0, 0.2));
  scene.bodies[1].velocity = {0.0, 2.0};
  scene.cables.push_back(cable(at(-0.21, -1.0), {{2, -1, 0}, {1, 1, 0}, {3, -1, 0}}, on(0), 0.01));
  scene.cables[0].mass_per_metre = 5.0;
  scene.cables.push_back(cable(on(1), {}, on(0), 0.01));
  scene.cables[1].slack = 0.05;
  World world = make_world(scene, Method::pinch);
  EXPECT_EQ(world.cables[0].links.size(), 5U);
  double most = 0.0;
  for (int i = 0; i < 40; ++i) {
    run(scene, world, 1);
    most = std::max(most, world.cables[1].segments[1].tension);
  }
  EXPECT_EQ(world.cables[0].links.size(), 4U);
  EXPECT_GT(most, 0.0);
  // Without events kicks are of one length, and what is made for one stands.
  Configuration at_steps(Method::pinch);
  at_steps.events = Events::at_steps;
  EXPECT_TRUE(is_all_state(scene, Method::pinch, 40));
  EXPECT_TRUE(is_all_state(scene, at_steps, 40));
}

TEST(Mass, RefuseWhatCannotBe) {
  const auto refusal = [](auto change) -> std::string {
    Scene scene = swinging_bob(4);
    change(scene);
    return message_of<SceneError>([&scene] { make_world(scene, Method::pinch); });
  };
  EXPECT_EQ(refusal([](Scene&) {}), "");
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].mass_per_metre = infinity; }).find("a number"),
            std::string::npos);
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].nodes = 3; }).find("spread_nodes"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::testing
