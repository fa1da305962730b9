// SPDX-License-Identifier: GPL-3.0-or-later
// What comes upon the end of a cable that is held in the world.

#include <array>
#include <cmath>

#include "sim/lines.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "tests/sim/course.h"
#include "tests/sim/random.h"

namespace pinchlab::testing {
namespace {

constexpr double radius = 0.4, half_width = 0.05;  // m
constexpr double apart = radius + half_width;  // m, the ball's centre from the end that it touches

/// A weight that hangs on a cable from the origin, and a free ball, body 0.
Scene hanging_weight(const Vec2& ball, const Vec2& velocity) {
  Scene scene;
  scene.bodies = {body("ball", BodyKind::free, ball.x(), ball.y(), radius, 2.0),
                  body("weight", BodyKind::free, 0.0, -5.0, 0.3, 3.0)};
  scene.bodies[0].velocity = velocity;
  scene.cables = {cable(at(0.0, 0.0), {}, on(1), half_width)};
  return scene;
}

/// A ball that starts at `speed` (m/s) on top of the end slides down a circle about it, without
/// friction, and leaves it where g cos(th) = th'^2 L. Its place after `seconds`, by Runge and
/// Kutta's method in many small steps and then in free flight.
Vec2 slid_off(double speed, double seconds) {
  constexpr double h = 1e-5;
  double angle = 0.0, rate = speed / apart, t = 0.0;
  for (; g * std::cos(angle) > rate * rate * apart && t < seconds; t += h) {
    const auto pull = [](double a) { return g / apart * std::sin(a); };
    const double k1 = pull(angle), k2 = pull(angle + 0.5 * h * rate),
                 k3 = pull(angle + 0.5 * h * rate + 0.25 * h * h * k1),
                 k4 = pull(angle + h * rate + 0.5 * h * h * k2);
    angle += h * rate + h * h / 6.0 * (k1 + k2 + k3);
    rate += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  const double left = seconds - t;
  const Vec2 way(std::cos(angle), -std::sin(angle));
  return apart * Vec2(std::sin(angle), std::cos(angle)) + left * apart * rate * way +
         Vec2(0.0, -0.5 * g * left * left);
}

TEST(CableEnd, ABallRestsOnIt) {
  for (const int steps_per_frame : {1, 4, 16}) {
    Scene scene = hanging_weight({0.0, 1.0}, Vec2::Zero());
    scene.steps_per_frame = steps_per_frame;
    World world = make_world(scene, measured());
    run(scene, world, 60 * steps_per_frame);
    EXPECT_NEAR(world.position[0].x(), 0.0, 1e-12);
    EXPECT_NEAR(world.position[0].y(), apart, 1e-12);
    ASSERT_EQ(world.contacts.size(), 1u);
    EXPECT_NEAR(world.contacts[0].normal_force, 2.0 * g, 1e-9);
  }
}

TEST(CableEnd, ABallSlidesOffIt) {
  const Vec2 exact = slid_off(0.5, 0.6);
  std::array<double, 3> error{};
  constexpr std::array<int, 3> ladder{4, 16, 64};
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    Scene scene = hanging_weight({0.0, apart}, {0.5, 0.0});
    scene.steps_per_frame = ladder[i];
    World world = make_world(scene, measured());
    run(scene, world, 36 * ladder[i]);
    EXPECT_EQ(world.angle[0], 0.0);
    error[i] = (world.position[0] - exact).norm();
  }
  EXPECT_LT(error[0], 2e-3);
  EXPECT_LT(error[1], error[0] / 8.0);
  EXPECT_LT(error[2], error[1] / 8.0);
}

TEST(CableEnd, ABallThatComesAlongTheCableReboundsExactly) {
  for (const int steps_per_frame : {1, 4, 16}) {
    Scene scene;
    scene.gravity = Vec2::Zero();
    scene.steps_per_frame = steps_per_frame;
    scene.bodies = {body("ball", BodyKind::free, -2.0, 0.0, radius)};
    scene.bodies[0].velocity = {3.0, 0.0};
    scene.bodies[0].restitution = 0.5;
    scene.cables = {cable(at(0.0, 0.0), {}, at(4.0, 0.0), half_width)};
    World world = make_world(scene, measured());
    run(scene, world, 60 * steps_per_frame);
    const double way = 2.0 - apart;
    EXPECT_NEAR(world.position[0].x(), -apart - 1.5 * (1.0 - way / 3.0), 1e-11);
    EXPECT_EQ(world.position[0].y(), 0.0);
  }
}

/// How far a ball, body 0, is in the cable's spans that do not run round it (m).
double depth(const World& world) {
  double most = -infinity;
  const CableState& cable = world.cables[0];
  for (std::size_t i = 1; i < cable.segments.size(); ++i) {
    if (cable.links[i].body == 0 || cable.links[i - 1].body == 0) continue;
    const Segment& span = cable.segments[i];
    most = std::max(most, apart - distance_from_line(span.tail, span.head, world.position[0]));
  }
  return most;
}

/// A ball from beyond the upper end of a slack span slides over it and down the span.
Vec2 slid_over(const Cable& span, int steps_per_frame) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies = {body("ball", BodyKind::free, -0.05, apart + 0.1, radius)};
  scene.bodies[0].velocity = {1.0, 0.0};
  scene.bodies[0].cable_friction = 0.0;
  scene.cables = {span};
  scene.cables[0].slack = 0.02;
  World world = make_world(scene, measured());
  Workspace work;
  bool touched = false, carried = false;
  for (int i = 0; i < 60 * steps_per_frame; ++i) {
    EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    EXPECT_LT(depth(world), 1e-9) << steps_per_frame << ", step " << i;
    EXPECT_LT(world.diagnostics.largest_gap_violation, 1e-9);
    for (const Contact& c : world.contacts) touched = touched || c.touching;
    carried = carried || world.cables[0].links.size() == 3;
  }
  EXPECT_TRUE(touched);
  EXPECT_TRUE(carried);
  return world.position[0];
}

TEST(CableEnd, ABallSlidesOverItOnToTheSpan) {
  for (const int steps_per_frame : {1, 4, 16}) {
    const Attachment high = at(0.0, 0.0), low = at(2.0, -1.0);
    const Vec2 one = slid_over(cable(high, {}, low, half_width), steps_per_frame);
    const Vec2 other = slid_over(cable(low, {}, high, half_width), steps_per_frame);
    EXPECT_LT((one - other).norm(), 1e-9) << steps_per_frame;
  }
}

TEST(CableEnd, ABoxLiesOnIt) {
  for (const int steps_per_frame : {1, 4}) {
    Scene scene = hanging_weight({0.0, 1.0}, Vec2::Zero());
    scene.steps_per_frame = steps_per_frame;
    make_polygon(scene.bodies[0], {{-0.3, -0.2}, {0.3, -0.2}, {0.3, 0.2}, {-0.3, 0.2}}, 0.0);
    World world = make_world(scene, measured());
    run(scene, world, 60 * steps_per_frame);
    EXPECT_NEAR(world.position[0].y(), 0.2 + half_width, 1e-10);
  }
}

// There the rope could not bend round it if it came nearer.
TEST(CableEnd, ABallRestsATenthOfAHalfWidthOffThatOfARope) {
  for (const int steps_per_frame : {1, 4, 16}) {
    Scene scene = hanging_weight({0.0, 1.0}, Vec2::Zero());
    scene.steps_per_frame = steps_per_frame;
    scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 2.0, -0.4, 0.35));
    scene.bodies[1].position = {2.4, -5.0};
    scene.cables = {cable(at(0.0, 0.0), {{2, -1, 0}}, on(1), half_width)};
    scene.cables[0].mass_per_metre = 0.5;
    World world = make_world(scene, measured());
    run(scene, world, 60 * steps_per_frame);
    EXPECT_NEAR(world.position[0].y(), apart + 0.1 * half_width, 1e-12);
  }
}

/// A ball, body 0, of any size, mass and way that is thrown at the end of a rope, or near it, which
/// runs over a pulley to a weight.
Scene thrown_at_rope(unsigned seed, int nodes) {
  Random random(seed);
  Scene scene;
  // One after another: arguments are evaluated in any order.
  const double mass = random.spread(0.02, 30.0), size = random.uniform(0.05, 0.5);
  const double height = random.uniform(-1.0, 0.0);
  const BodyKind kind = random.below(2) == 0 ? BodyKind::fixed : BodyKind::fixed_axle;
  scene.bodies = {body("ball", BodyKind::free, 0.0, 0.0, size, mass),
                  body("pulley", kind, 2.5, height, 0.3),
                  body("weight", BodyKind::free, 2.9, -3.0, 0.2, random.spread(0.5, 20.0))};
  Body& ball = scene.bodies[0];
  const double from = random.uniform(1.5, 4.5);  // rad: from beyond it
  const double to = from + random.uniform(-0.2, 0.2), speed = random.uniform(1.0, 10.0);
  ball.position = (ball.radius + 0.6) * Vec2(std::cos(from), std::sin(from));
  ball.velocity = -speed * Vec2(std::cos(to), std::sin(to));
  ball.angular_velocity = random.uniform(-10.0, 10.0);
  ball.restitution = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 1.0);
  if (random.below(3) == 0) ball.cable_friction = random.uniform(0.0, 1.0);
  scene.cables = {cable(at(0.0, 0.0), {{1, -1, 0}}, on(2), 0.02)};
  scene.cables[0].mass_per_metre = 0.5;
  scene.cables[0].nodes = nodes;
  if (nodes > 0) {
    scene.cables[0].slack = random.below(2) == 0 ? 0.02 : 0.1;
    spread_nodes(scene);
  }
  return scene;
}

TEST(CableEnd, WhatComesUponThatOfARopeMakesNoEnergy) {
  int come_upon = 0;
  for (const int nodes : {0, 8}) {
    for (unsigned seed = 1; seed <= seeds_of(60U); ++seed) {
      Scene scene = thrown_at_rope(seed, nodes);
      for (const int steps_per_frame : {1, 4, 16}) {
        scene.steps_per_frame = steps_per_frame;
        const Course course = run_measured(scene, 0.5);
        EXPECT_LT(course.gained, 1e-6 * course.at_play) << seed << ", " << nodes << " nodes";
        EXPECT_LT(course.gap, 1e-9) << seed << ", " << nodes << " nodes";
      }
      World world = make_world(scene, Method::pinch);
      Workspace work;
      double nearest = infinity;
      for (int i = 0; i < 480; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok);
        nearest = std::min(nearest, world.position[0].norm() - scene.bodies[0].radius);
      }
      EXPECT_GT(nearest, 0.999 * 1.1 * 0.02);
      come_upon += nearest < 1.5 * 0.02 ? 1 : 0;
    }
  }
  EXPECT_GT(come_upon, seeds_of(30));
}

// A pendulum whose bob hangs over its pivot.
TEST(CableEnd, IsPassedWhereABodyStartsOverIt) {
  Scene scene;
  scene.bodies = {body("bob", BodyKind::free, 0.0, -0.3, radius)};
  scene.cables = {cable(at(0.0, 0.0), {}, on(0), half_width)};
  EXPECT_TRUE(make_world(scene, Method::pinch).obstacles.empty());
  scene.bodies[0].position.y() = -apart;
  EXPECT_EQ(make_world(scene, Method::pinch).obstacles.size(), 1u);
}

TEST(CableEnd, IsPassedWithoutPinchJointsAndByJoints) {
  const Scene scene = hanging_weight({0.0, 1.0}, Vec2::Zero());
  for (const Method method : {Method::pinch_no_contact, Method::cable}) {
    EXPECT_TRUE(make_world(scene, method).obstacles.empty());
  }
  EXPECT_TRUE(make_world(scene, thesis_configuration()).obstacles.empty());
  Scene bar = scene;
  bar.cables[0].rod = true;
  EXPECT_TRUE(make_world(bar, Method::pinch).obstacles.empty());
}

}  // namespace
}  // namespace pinchlab::testing
