// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms of ideal massless cables. Where the motion is uniformly accelerated the leapfrog's
// discrete solution is the continuous one, so the tolerance is round-off; where it is curved, see
// convergence_test.cpp.

#include <numbers>

#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double R = 0.55;  // radius + half width of load_chain's pulleys

double tension(const World& world, std::size_t segment, std::size_t cable = 0) {
  return world.cables[cable].segments[segment].tension;
}

TEST(Exact, AtwoodMachine) {
  const double m1 = 1.0, m2 = 3.0, pulley = 2.0, inertia = 0.5 * pulley * 0.25;
  const double a = (m2 - m1) * g / (m1 + m2 + inertia / (R * R));
  for (const int steps_per_frame : {1, 4}) {
    Scene scene = load_chain(1, m1, m2, pulley);
    scene.steps_per_frame = steps_per_frame;
    World world = make_world(scene, measured());
    Workspace work;
    const double y1 = world.position[0].y(), y2 = world.position[1].y();
    run(scene, world, 60 * steps_per_frame);
    EXPECT_NEAR(world.position[0].y() - y1, 0.5 * a, 1e-12);
    EXPECT_NEAR(y2 - world.position[1].y(), 0.5 * a, 1e-12);
    EXPECT_NEAR(tension(world, 1), m1 * (g + a), 1e-9);
    EXPECT_NEAR(tension(world, 2), m2 * (g - a), 1e-9);
    const Velocities now = velocities_now(scene, world, work);
    EXPECT_NEAR(now.linear[0].y(), a, 1e-12);
    EXPECT_NEAR(now.angular[2], -a / R, 1e-12);
  }
}

// 1000 kg against 999 kg over light pulleys, ratio 1e4, at one step a frame: sweeps fail here by a
// factor of 1000.
TEST(Exact, ChainOfPulleysAtOneStepAFrame) {
  for (const int pulleys : {1, 5, 21, 81}) {
    Scene scene = load_chain(pulleys, 1000.0, 999.0, 0.1);
    scene.steps_per_frame = 1;
    World world = make_world(scene, measured());
    const double y = world.position[0].y();
    run(scene, world, 60);
    const double inertia = 0.5 * 0.1 * 0.25;
    const double a = g / (1999.0 + pulleys * inertia / (R * R));
    EXPECT_NEAR(y - world.position[0].y(), 0.5 * a, 1e-9) << pulleys;
    EXPECT_EQ(world.diagnostics.total_solves, 60) << "the active set never changes";
  }
}

TEST(Exact, MassRatiosUpToABillion) {
  for (int power = 0; power <= 9; ++power) {
    const double ratio = std::pow(10.0, power);
    Scene scene = load_chain(21, ratio, 0.5 * ratio, 1.0);
    World world = make_world(scene, measured());
    const double y = world.position[0].y();
    run(scene, world, 240);
    const double a = 0.5 * ratio * g / (1.5 * ratio + 21 * 0.125 / (R * R));
    EXPECT_NEAR((y - world.position[0].y()) / (0.5 * a), 1.0, 1e-10) << ratio;
  }
}

TEST(Exact, CapstanSticksUpToItsRatio) {
  const double mu = 0.3, k = std::exp(mu * pi);
  for (const double share : {1.0 - 1e-9, 1.0 + 1e-9}) {
    for (const bool left_heavier : {true, false}) {
      const double light = 1.0, heavy = light * k * share;
      Scene scene =
          load_chain(1, left_heavier ? heavy : light, left_heavier ? light : heavy, 1.0, mu);
      scene.bodies[2].kind = BodyKind::fixed;
      World world = make_world(scene, measured());
      const double y = world.position[0].y();
      run(scene, world, 240);
      const double a = (heavy - k * light) * g / (heavy + k * light) * (left_heavier ? -1.0 : 1.0);
      const double moved = world.position[0].y() - y;
      if (share < 1.0) {
        EXPECT_EQ(world.cables[0].links[1].slip, Slip::stick);
        EXPECT_NEAR(moved, 0.0, 1e-13);
      } else {
        EXPECT_NE(world.cables[0].links[1].slip, Slip::stick);
        EXPECT_NEAR(moved, 0.5 * a, 1e-13);
      }
    }
  }
}

TEST(Exact, SlippingAtwoodAtOneStepAFrame) {
  const double m1 = 1.0, m2 = 3.0, pulley = 2.0, mu = 0.05, inertia = 0.5 * pulley * 0.25;
  const double k = std::exp(mu * pi);
  Scene scene = load_chain(1, m1, m2, pulley, mu);
  scene.steps_per_frame = 1;
  World world = make_world(scene, measured());
  Workspace work;
  const double y = world.position[1].y();
  run(scene, world, 60);
  const double a = g * (m2 - k * m1) / (m2 + k * m1), t1 = m1 * (g + a);
  EXPECT_NEAR(tension(world, 2) / tension(world, 1), k, 1e-12);
  EXPECT_NEAR(y - world.position[1].y(), 0.5 * a, 1e-12);
  EXPECT_NEAR(velocities_now(scene, world, work).angular[2], -(k - 1.0) * t1 * R / inertia, 1e-10);
  EXPECT_EQ(world.cables[0].links[1].slip, Slip::forward);
  EXPECT_NEAR(world.diagnostics.largest_stretch, 0.0, 1e-13);
}

TEST(Exact, FrictionlessPulleyDoesNotTurn) {
  Scene scene = load_chain(3, 1.0, 2.0, 1.0, 0.0);
  World world = make_world(scene, measured());
  const double y = world.position[1].y();
  run(scene, world, 240);
  EXPECT_NEAR(y - world.position[1].y(), 0.5 * g / 3.0, 1e-12);
  for (std::size_t b = 2; b < 5; ++b) EXPECT_EQ(world.angle[b], 0.0);
  EXPECT_NEAR(tension(world, 1), tension(world, 4), 1e-11);
}

/// A body that unrolls a cable wound three times round it, hanging from the world.
Scene yo_yo() {
  Scene scene;
  Body b = body("yo-yo", BodyKind::free, R, -2.0, 0.5, 2.0);
  scene.bodies.push_back(b);
  // The cable comes from above on the left side: counter-clockwise round the body, to its rim.
  scene.cables.push_back(cable(at(0.0, 0.0), {{0, 1, 3}}, {0, {0.0, -R}}));
  return scene;
}

TEST(Exact, YoYo) {
  Scene scene = yo_yo();
  World world = make_world(scene, measured());
  Workspace work;
  EXPECT_NEAR(world.cables[0].links[1].wrap, 3.25 * 2.0 * pi, 1e-9);
  const double y = world.position[0].y();
  run(scene, world, 240);
  const double m = 2.0, inertia = 0.5 * m * 0.25, a = g / (1.0 + inertia / (m * R * R));
  EXPECT_NEAR(y - world.position[0].y(), 0.5 * a, 1e-12);
  EXPECT_NEAR(tension(world, 1), m * (g - a), 1e-10);
  EXPECT_NEAR(velocities_now(scene, world, work).angular[0], -a / R, 1e-12);
  EXPECT_NEAR(world.position[0].x(), R, 1e-12) << "hangs straight down";
}

/// n falls between a fixed and a moving block; the cable runs from the moving load's hook over n
/// sheaves to a counterweight. Straight falls need sheaves in rows, so the loads here share rails.
TEST(Exact, BlockAndTackleOfTwoFalls) {
  const double load = 3.0, counter = 2.0, n = 2.0;
  Scene scene;
  scene.bodies.push_back(body("load", BodyKind::rail, 0.0, -4.0, 0.5, load));
  scene.bodies.push_back(body("top", BodyKind::fixed_axle, 2.0 * R, 0.0, 0.5, 1.0));
  scene.bodies.push_back(body("counterweight", BodyKind::free, 3.0 * R, -2.0, 0.3, counter));
  for (auto& b : scene.bodies) b.cable_friction = 0.0;
  // World anchor, down round the moving sheave (which is the load), up over the fixed one, down.
  scene.cables.push_back(cable(at(-R, 0.0), {{0, 1, 0}, {1, -1, 0}}, on(2)));
  World world = make_world(scene, measured());
  const double y = world.position[0].y(), z = world.position[2].y();
  run(scene, world, 120);
  const double a = g * (n * counter - load) / (load + n * n * counter);
  EXPECT_NEAR(world.position[0].y() - y, 0.5 * a * 0.25, 1e-12);
  EXPECT_NEAR(z - world.position[2].y(), n * 0.5 * a * 0.25, 1e-12);
}

TEST(Exact, BlockAndTackleInBalance) {
  Scene scene;
  scene.bodies.push_back(body("load", BodyKind::rail, 0.0, -4.0, 0.5, 2.0));
  scene.bodies.push_back(body("top", BodyKind::fixed_axle, 2.0 * R, 0.0, 0.5, 1.0));
  scene.bodies.push_back(body("counterweight", BodyKind::free, 3.0 * R, -2.0, 0.3, 1.0));
  scene.cables.push_back(cable(at(-R, 0.0), {{0, 1, 0}, {1, -1, 0}}, on(2)));
  World world = make_world(scene, measured());
  run(scene, world, 240);
  for (std::size_t s = 1; s <= 3; ++s) EXPECT_NEAR(tension(world, s), g, 1e-10);
  EXPECT_LT(world.velocity[0].norm(), 1e-12);
}

// Equal wheels: wrap pi each. Tension 2 T0 in all, where only the spans l are stretched; the driver
// stands against a wheel that torque turns. Where rims carry the belt stretched, they have, as it
// slips, R (T1 - T2) / (mu EA) of its stretch each: T2 ((k + 1) l + 2 R (k - 1) / mu) =
// 2 T0 (l + pi R), k = exp(mu pi).
TEST(Exact, BeltTransmitsUpToItsTorqueLimit) {
  const double mu = 0.4, k = std::exp(mu * pi), t0 = 50.0, l = 3.0;
  for (const bool creep : {false, true}) {
    const double ways = creep ? l + pi * R : l;
    const double slack = 2.0 * t0 * ways / ((k + 1.0) * l + (creep ? 2.0 * R * (k - 1.0) / mu : 0));
    const double limit = R * (k - 1.0) * slack;
    for (const double share : {0.99, 1.01}) {
      Scene scene;
      scene.bodies.push_back(body("driver", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 1.0));
      scene.bodies.push_back(body("driven", BodyKind::fixed_axle, l, 0.0, 0.5, 1.0));
      for (auto& b : scene.bodies) b.cable_friction = mu;
      scene.bodies[0].driven_angular_velocity = 0.0;
      scene.bodies[1].torque = share * limit;
      Cable belt = cable({}, {{0, 1, 0}, {1, 1, 0}}, {});
      belt.closed = true;
      belt.axial_stiffness = 1e6;
      belt.creep = creep;
      belt.slack = -2.0 * ways * t0 / belt.axial_stiffness;
      scene.cables.push_back(belt);
      World world = make_world(scene, measured());
      run(scene, world, 480);
      const double turned = world.angle[1], sum = tension(world, 0) + tension(world, 1);
      if (share < 1.0) {
        EXPECT_LT(std::abs(turned), 1e-3) << creep;
        EXPECT_GT(sum, 2.0 * t0 - 0.01 * t0) << creep;
        EXPECT_LT(sum, (k + 1.0) * slack + 0.01 * t0) << creep;
      } else {
        // Beyond the limit the excess accelerates the wheel. What creeps is behind by what comes on
        // in a step.
        const double error = creep ? 0.15 : 0.02;  // of the excess
        const double alpha = (share - 1.0) * limit / (0.5 * 0.25);
        EXPECT_NEAR(turned, 0.5 * alpha * 4.0, error * 0.5 * alpha * 4.0) << creep;
      }
    }
  }
}

TEST(Exact, BeltKeepsTheRatioOfSpeeds) {
  Scene scene;
  scene.bodies.push_back(body("driver", BodyKind::fixed_axle, 0.0, 0.0, 0.95, 1.0));
  scene.bodies.push_back(body("driven", BodyKind::fixed_axle, 3.0, 0.0, 0.45, 1.0));
  scene.bodies[0].driven_angular_velocity = 2.0;
  Cable belt = cable({}, {{0, 1, 0}, {1, 1, 0}}, {});
  belt.closed = true;
  scene.cables.push_back(belt);
  World world = make_world(scene, measured());
  run(scene, world, 2400);
  EXPECT_NEAR(world.angular_velocity[1], 2.0 * 1.0 / 0.5, 1e-9);
  EXPECT_NEAR(world.angle[1], world.angle[0] * 2.0, 1e-9);
  EXPECT_LT(world.diagnostics.cable_length_error, 1e-12);
}

TEST(Exact, ElasticCableHangsByHookesLaw) {
  Scene scene;
  scene.bodies.push_back(body("load", BodyKind::free, 0.0, -2.0, 0.2, 3.0));
  scene.bodies[0].linear_drag = 20.0;
  Cable c = cable(at(0.0, 0.0), {}, on(0));
  c.axial_stiffness = 500.0;
  scene.cables.push_back(c);
  World world = make_world(scene, measured());
  run(scene, world, 240 * 20);
  const double strain = 3.0 * g / 500.0;
  EXPECT_NEAR(-world.position[0].y(), 2.0 * (1.0 + strain), 1e-9);
  EXPECT_NEAR(tension(world, 1), 3.0 * g, 1e-7);
}

// Two equal inextensible cables side by side: the solution of least norm shares the load as equally
// stiff cables do.
TEST(Exact, RepeatedCablesShareTheLoad) {
  Scene scene;
  scene.bodies.push_back(body("load", BodyKind::free, 0.0, -2.0, 0.2, 3.0));
  for (int i = 0; i < 3; ++i) {
    scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0)));
  }
  World world = make_world(scene, measured());
  run(scene, world, 240);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(tension(world, 1, c), g, 1e-6);
  EXPECT_NEAR(world.position[0].y(), -2.0, 1e-12);
}

TEST(Exact, PendulumOnAPegRisesToItsOldHeight) {
  Scene scene;
  scene.steps_per_frame = 64;
  const double length = 2.0, start = 0.8;
  scene.bodies.push_back(
      body("bob", BodyKind::free, -length * std::sin(start), -length * std::cos(start), 0.05, 1.0));
  scene.bodies.push_back(body("peg", BodyKind::fixed, 0.02, -1.0, 0.01, 1.0));
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 1e-3));
  World world = make_world(scene, measured());
  Workspace work;
  const double height = world.position[0].y();
  double highest = -10.0;
  bool wrapped = false;
  for (int i = 0; i < 60 * 64 * 2; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    if (world.cables[0].links.size() == 3) {
      wrapped = true;
      highest = std::max(highest, world.position[0].y());
    }
  }
  EXPECT_TRUE(wrapped);
  EXPECT_NEAR(highest, height, 2e-5);  // second order in the step; 64 steps a frame
}

TEST(Exact, RollerRestsOnTheWrapAndLeavesExactlyTheCableBetween) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 1.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, 0.5 + 0.25 + 0.1, 0.25, 2.0));
  scene.cables.push_back(cable(at(-1.0, -2.0), {{0, -1, 0}}, at(1.0, -2.0)));
  World world = make_world(scene, measured());
  run(scene, world, 2400);
  ASSERT_EQ(world.contacts.size(), 1u);
  EXPECT_NEAR(world.contacts[0].gap, 0.1, 1e-13);
  EXPECT_NEAR(world.contacts[0].normal_force, 2.0 * g, 1e-9);
  EXPECT_LT(std::abs(world.velocity[1].y()), 1e-12);
  // Horizontals are a quarter turn from the y axis, in doubles off by 6e-17: this is of second
  // order in it.
  EXPECT_LT(std::abs(world.angle[0]), 1e-28);
}

// On a rail at angle beta from the vertical a roller presses with m g cos(beta).
TEST(Exact, ContactForceIsTheWeightsComponent) {
  const double beta = 0.3;
  Scene scene;
  const Vec2 axis(std::sin(beta), std::cos(beta));
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 1.0));
  Body roller = body("roller", BodyKind::rail, 0.85 * axis.x(), 0.85 * axis.y(), 0.25, 2.0);
  roller.rail_axis = axis;
  scene.bodies.push_back(roller);
  scene.cables.push_back(cable(at(-1.0, -2.0), {{0, -1, 0}}, at(1.0, -2.0)));
  World world = make_world(scene, measured());
  run(scene, world, 240);
  ASSERT_EQ(world.contacts.size(), 1u);
  EXPECT_NEAR(world.contacts[0].normal_force, 2.0 * g * std::cos(beta), 1e-9);
}

}  // namespace
}  // namespace pinchlab::testing
