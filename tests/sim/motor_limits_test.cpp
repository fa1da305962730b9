// SPDX-License-Identifier: GPL-3.0-or-later
// Motors against what a drum of known inertia must do, and against cables that cannot give.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "sim/joints.h"
#include "sim/scene_error.h"
#include "sim/step.h"
#include "sim/workspace.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double g = 9.81, radius = 0.3, half_width = 0.02, arm = radius + half_width;
constexpr double drum_mass = 4.0, inertia = 0.5 * drum_mass * radius * radius;

/// A drum whose rope hangs down on its right with a weight on it; positive turning hauls it up.
Scene winch(double weight, double speed, double limit) {
  Scene scene;
  Body drum;
  drum.name = "drum";
  drum.kind = BodyKind::fixed_axle;
  drum.radius = radius;
  drum.mass = drum_mass;
  drum.driven_angular_velocity = speed;
  drum.torque_limit = limit;
  Body load;
  load.name = "load";
  load.radius = 0.1;
  load.mass = weight;
  load.position = Vec2(arm, -5.0);
  scene.bodies = {drum, load};
  Cable rope;
  rope.name = "rope";
  rope.half_width = half_width;
  rope.start = {1, Vec2::Zero()};
  rope.wraps = {{0, 1, 3}};
  rope.end = {0, Vec2(-arm, 0.0)};
  scene.cables = {rope};
  return scene;
}

World run_for(const Scene& scene, double seconds, int steps_per_frame) {
  Scene divided = scene;
  divided.steps_per_frame = steps_per_frame;
  World world = make_world(divided, Method::pinch);
  Workspace work;
  const int steps = static_cast<int>(std::lround(seconds / world.step_length));
  for (int i = 0; i < steps; ++i) {
    if (step(divided, world, work) != StepStatus::ok) ADD_FAILURE() << world.failure;
  }
  return world;
}

double most_stretched(const World& world) {
  double most = 0.0;
  for (const CableState& cable : world.cables) {
    for (const Segment& s : cable.segments) most = std::max(most, s.length - s.rest_length);
  }
  return most;
}

/// Angular acceleration with all of a torque, and the weight on the drum.
double acceleration(double weight, double torque) {
  return (torque - weight * g * arm) / (inertia + weight * arm * arm);
}

// What a torque limit is for: the drum and its load get to speed as its inertia says.
TEST(MotorLimits, GetToSpeedByTheirTorque) {
  const double weight = 2.0, speed = 3.0, limit = 7.2;
  const double alpha = acceleration(weight, limit), until = speed / alpha;
  ASSERT_GT(alpha, 0.0);
  double before = 0.0;
  for (const int steps : {1, 4, 16}) {
    const World early = run_for(winch(weight, speed, limit), 0.5, steps);
    ASSERT_GT(until, 0.5);
    EXPECT_NEAR(early.angle[0], 0.5 * alpha * 0.25, 1e-9) << steps;
    const World late = run_for(winch(weight, speed, limit), 2.0, steps);
    const double angle = speed * (2.0 - 0.5 * until);
    EXPECT_NEAR(late.position[1].y(), -5.0 + arm * late.angle[0], 1e-9) << steps;
    const double error = std::abs(late.angle[0] - angle);
    EXPECT_LT(error, speed / (60.0 * steps) / (60.0 * steps)) << steps;
    EXPECT_NEAR(late.angular_velocity[0], speed, 1e-12) << steps;
    before = error;
  }
  EXPECT_LT(before, 1e-5);
}

TEST(MotorLimits, AreTurnedBackByWhatIsTooHeavy) {
  const double weight = 5.0, limit = 10.0;
  const double alpha = acceleration(weight, limit);
  ASSERT_LT(alpha, 0.0);
  // The motor is asked for 3 rad/s, and the load pulls it the other way.
  for (const int steps : {1, 8}) {
    const World world = run_for(winch(weight, 3.0, limit), 1.0, steps);
    EXPECT_NEAR(world.angle[0], 0.5 * alpha, 1e-9) << steps;
    EXPECT_LT(most_stretched(world), 1e-12) << steps;
  }
}

// A brake is a motor that is to stand still: it does, as long as it can.
TEST(MotorLimits, HoldWhatTheyCan) {
  const World held = run_for(winch(3.0, 0.0, 3.0 * g * arm * 1.001), 1.0, 2);
  EXPECT_NEAR(held.angle[0], 0.0, 1e-12);
  EXPECT_NEAR(held.position[1].y(), -5.0, 1e-12);
  const World slips = run_for(winch(3.0, 0.0, 3.0 * g * arm * 0.999), 1.0, 2);
  EXPECT_NEAR(slips.angle[0], 0.5 * acceleration(3.0, 3.0 * g * arm * 0.999), 1e-9);
}

// No torque that is limited changes anything in the instant of a catch: the drum is jerked round.
TEST(MotorLimits, AreJerkedByACatch) {
  const double weight = 2.0, slack = 0.8, limit = 20.0;
  Scene scene = winch(weight, 0.0, limit);
  scene.cables[0].slack = slack;
  const double falls = std::sqrt(2.0 * slack / g), speed = g * falls;
  const double jerked = -weight * speed * arm / (inertia + weight * arm * arm);  // rad/s
  const double alpha = acceleration(weight, limit);
  ASSERT_GT(alpha, 0.0);
  const double seconds = falls - 0.5 * jerked / alpha;  // half of the way to standing still
  const double angle = 0.75 * 0.5 * jerked * (-jerked / alpha);
  for (const int steps : {1, 4}) {
    Scene divided = scene;
    divided.steps_per_frame = steps;
    const double whole = std::round(seconds * 60.0) / 60.0;
    const World world = run_for(divided, whole, steps);
    const double t = whole - falls;
    EXPECT_NEAR(world.angle[0], jerked * t + 0.5 * alpha * t * t, 1e-9) << steps;
    EXPECT_NEAR(angle, jerked * (seconds - falls) + 0.5 * alpha * std::pow(seconds - falls, 2),
                1e-12);
  }
}

// A rope that cannot give stops a motor that knows no limit; nothing gets longer than it is, and
// when the motor is reversed the rope comes off as if nothing had been.
TEST(MotorLimits, StallWhereTheCableCannotGive) {
  for (const double limit : {infinity, 30.0}) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = winch(1.0, 4.0, limit);
      scene.bodies.pop_back();
      scene.cables[0].start = {-1, Vec2(arm, -5.0)};
      scene.cables[0].slack = 0.5;
      scene.bodies[0].motor = {{0.0, 4.0}, {1.0, 4.0}, {1.1, -4.0}};
      const double turned = 0.5 / arm;
      const World jammed = run_for(scene, 0.9, steps);
      EXPECT_NEAR(jammed.angle[0], turned, 1e-9) << limit << ' ' << steps;
      EXPECT_NEAR(jammed.angular_velocity[0], 0.0, 1e-12) << limit << ' ' << steps;
      EXPECT_LT(most_stretched(jammed), 1e-12) << limit << ' ' << steps;
      const World reversed = run_for(scene, 1.5, steps);
      EXPECT_LT(most_stretched(reversed), 1e-12) << limit << ' ' << steps;
      if (limit == infinity) {
        EXPECT_NEAR(reversed.angle[0], turned - 4.0 * (0.4 + 0.025), 1e-9) << steps;
      } else {
        EXPECT_LT(reversed.angle[0], turned - 1.0) << steps;
      }
    }
  }
}

// A load is hauled up to the end of its travel, with a spring below it that pulls it down. It stays
// there: what has stalled holds what it has wound up, at the time of the positions too. Half of a
// kick let it down at each event, and in the tables for good.
TEST(MotorLimits, HoldWhatTheyHaveWoundUp) {
  for (const double pull : {0.0, 200.0}) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = winch(4.0, 5.0, infinity);
      scene.bodies[1].kind = BodyKind::rail;
      scene.bodies[1].rail_axis = Vec2(0.0, 1.0);
      scene.steps_per_frame = steps;
      add_stops(scene, 1, -1.0, 0.5);
      if (pull > 0.0) add_spring(scene, "spring", on(1), {-1, {arm, -6.5}}, pull, 1.0, 0.0);
      World world = make_world(scene, Method::pinch);
      Workspace work, of_table;
      for (int i = 0; i < 60 * steps; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
        if (i < 24 * steps) continue;
        EXPECT_NEAR(world.position[1].y(), -4.5, 1e-9) << pull << ", " << steps << ": " << i;
        const Velocities now = velocities_now(scene, world, of_table);
        EXPECT_NEAR(now.linear[1].y(), 0.0, 1e-9) << pull << ", " << steps << ": " << i;
        EXPECT_NEAR(now.angular[0], 0.0, 1e-9) << pull << ", " << steps << ": " << i;
      }
    }
  }
}

/// A sheave whose brake is put on while its counterweight goes down and its car up.
Scene elevator(double cable_friction, double limit) {
  Scene scene = winch(300.0, 0.0, limit);
  scene.bodies[0].mass = 20.0;
  scene.bodies[0].angular_velocity = 5.0;
  scene.bodies[0].cable_friction = cable_friction;
  Body counterweight = scene.bodies[1];
  counterweight.name = "counterweight";
  counterweight.mass = 250.0;
  counterweight.position = Vec2(-arm, -4.0);
  scene.bodies.push_back(counterweight);
  scene.bodies[1].velocity = Vec2(0.0, 5.0 * arm);
  scene.bodies[2].velocity = Vec2(0.0, -5.0 * arm);
  scene.cables[0].wraps = {{0, 1}};
  scene.cables[0].end = {2, Vec2::Zero()};
  return scene;
}

// A rope that rubs and does not slip brakes as one that cannot, at the time of the positions too:
// there the motor was taken to hold without it, and the rope, slack by that, not to come back.
TEST(MotorLimits, BrakeByARopeThatRubs) {
  const double limit = 900.0, of_sheave = 0.5 * 20.0 * radius * radius;
  const double alpha = (limit + 50.0 * g * arm) / (of_sheave + 550.0 * arm * arm);
  for (const int steps : {1, 4, 16}) {
    Scene scene = elevator(0.6, limit);
    scene.steps_per_frame = steps;
    World world = make_world(scene, Method::pinch);
    Workspace work, of_table;
    for (int i = 0; i < 15 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      const double turning = 5.0 - alpha * (i + 1) * world.step_length;
      const Velocities now = velocities_now(scene, world, of_table);
      ASSERT_NEAR(now.angular[0], turning, 1e-9) << steps << ": " << i;
      EXPECT_NEAR(now.linear[1].y(), turning * arm, 1e-9) << steps << ": " << i;
      EXPECT_NEAR(now.linear[2].y(), -turning * arm, 1e-9) << steps << ": " << i;
    }
  }
}

// Velocities are taken on at each corner of a motor's table.
TEST(MotorLimits, FollowATableByARopeThatRubs) {
  for (const int steps : {1, 4, 16}) {
    std::array<Scene, 2> scenes = {elevator(0.6, 500.0), elevator(infinity, 500.0)};
    for (Scene& scene : scenes) {
      for (int corner = 0; corner <= 25; ++corner) {
        const double time = 0.02 * corner;
        scene.bodies[0].motor.push_back(
            {time, 2.5 * (1.0 + std::cos(2.0 * std::numbers::pi * time))});
      }
    }
    const World rubs = run_for(scenes[0], 0.5, steps), holds = run_for(scenes[1], 0.5, steps);
    EXPECT_NEAR(rubs.angle[0], holds.angle[0], 1e-10) << steps;
    EXPECT_NEAR(rubs.position[1].y(), holds.position[1].y(), 1e-10) << steps;
    EXPECT_NEAR(rubs.position[2].y(), holds.position[2].y(), 1e-10) << steps;
  }
}

// A rope that cannot give over a pulley that turns, through a cable that slides, and by the other
// methods.
TEST(MotorLimits, StallOverAPulley) {
  for (const Method method : {Method::pinch, Method::cable}) {
    for (const double friction : {infinity, 0.2, 0.0}) {
      Scene scene = winch(1.0, 4.0, infinity);
      Body pulley = scene.bodies[0];
      pulley.name = "pulley";
      pulley.driven_angular_velocity.reset();
      pulley.position = Vec2(2.0 * arm, -3.0);
      pulley.cable_friction = friction;
      scene.bodies[1] = pulley;
      scene.cables[0].start = {-1, Vec2(3.0 * arm, 0.0)};
      scene.cables[0].wraps = {{1, 1, 0}, {0, 1, 3}};
      World world = make_world(scene, method);
      Workspace work;
      for (int i = 0; i < 240; ++i) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      EXPECT_NEAR(world.angle[0], 0.0, 1e-3) << friction;
      EXPECT_LT(most_stretched(world), 1e-6) << friction;
    }
  }
}

/// Drums that contradict each other by a belt, or by a rope that slides over a smooth peg, and a
/// third that lowers a load, which only a slack rope ties to the second of them.
Scene contradicting_drums(bool by_belt, const std::array<int, 3>& drums) {
  Scene scene;
  scene.bodies.resize(3);
  const auto [a, b, winch] = drums;
  const auto add = [&scene](int number, double x, double speed) {
    Body& drum = scene.bodies[index(number)];
    drum = body(fmt::format("drum {}", x), BodyKind::fixed_axle, x, 0.0, 0.2, 1.0);
    drum.driven_angular_velocity = speed;
  };
  add(a, 0.0, 1.0);
  add(b, 2.0, -2.0);
  add(winch, 5.0, 1.5);
  scene.bodies.push_back(body("load", BodyKind::free, 4.78, -3.0, 0.1, 2.0));
  scene.bodies.push_back(body("peg", BodyKind::fixed, 1.0, 1.0, 0.2, 1.0));
  scene.bodies[4].cable_friction = 0.0;
  Cable belt = cable({a, {-0.22, 0.0}}, {{a, -1, 0}, {4, -1, 0}, {b, -1, 0}}, {b, {0.22, 0.0}});
  if (by_belt) belt = Cable();
  belt.closed = by_belt;
  if (by_belt) belt.wraps = {{a, 1, 0}, {b, 1, 0}};
  scene.cables = {belt, cable(on(3), {{winch, -1, 2}}, {winch, {0.22, 0.0}}),
                  cable(on(3), {{b, 1, 0}}, {b, {-0.22, 0.0}})};
  scene.cables[2].slack = 3.0;
  for (const int c : {0, 1, 2}) {
    scene.cables[index(c)].half_width = 0.02;
    scene.cables[index(c)].name = fmt::format("cable {}", c);
  }
  return scene;
}

// The third goes on. It stalled with the others, as all of a part did, and dropped its load.
TEST(MotorLimits, OnlyThoseStallThatContradictEachOther) {
  for (const bool by_belt : {true, false}) {
    for (const std::array<int, 3>& drums : {std::array{0, 1, 2}, std::array{1, 2, 0}}) {
      World world = make_world(contradicting_drums(by_belt, drums), Method::pinch);
      run(contradicting_drums(by_belt, drums), world, 120);
      const auto [a, b, winch] = drums;
      EXPECT_NEAR(world.angle[index(winch)], 0.75, 1e-12) << by_belt;
      EXPECT_NEAR(world.position[3].y(), -3.0 - 0.22 * 0.75, 1e-12) << by_belt;
      // Equal drums, at 1 and -2 rad/s to begin with, share what they have.
      EXPECT_NEAR(world.angle[index(a)], -0.25, 1e-9) << by_belt;
      EXPECT_NEAR(world.angle[index(b)], -0.25, 1e-9) << by_belt;
      EXPECT_LT(most_stretched(world), 1e-12) << by_belt;
    }
  }
}

// The rope cannot give but by throwing the load along its rail, which is all but level: the drum is
// stopped instead, and the load hardly moves. One that did not stall would throw it for kilometres.
TEST(MotorLimits, StallWhereTheyWouldThrow) {
  for (const double mass : {0.01, 1.0}) {
    for (const double speed : {5.0, 50.0}) {
      Scene scene;
      scene.bodies = {body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.2, 1.0),
                      body("ball", BodyKind::free, 1.0, -1.0, 0.05, mass),
                      body("load", BodyKind::rail, -0.22, -2.0, 0.05, mass)};
      scene.bodies[0].driven_angular_velocity = -speed;
      scene.bodies[2].rail_axis = Vec2(1.0, 0.02).normalized();
      scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(1), 0.02));
      World world = make_world(scene, Method::pinch);
      run(scene, world, 120);
      EXPECT_LT((world.position[1] - scene.bodies[1].position).norm(), 1.0) << mass << ' ' << speed;
      EXPECT_LT((world.position[2] - scene.bodies[2].position).norm(), 1.0) << mass << ' ' << speed;
      EXPECT_LT(most_stretched(world), 1e-9) << mass << ' ' << speed;
    }
  }
}

// Sweeps know neither groups of sliding segments nor what contradicts a motor: they hold it.
// However slow: what a weight gains by falling for a step is no speed that the motor gives.
TEST(MotorLimits, SlowMotorsHoldWhatHangs) {
  for (const double speed : {1e-2, 1e-4, 1e-8}) {
    Scene scene;
    Body winch = body("winch", BodyKind::fixed_axle, 0.0, 0.0, 0.2);
    winch.driven_angular_velocity = speed;
    scene.bodies.push_back(winch);
    scene.bodies.push_back(body("weight", BodyKind::free, 0.25, -2.0, 0.1, 3.0));
    scene.cables.push_back(cable({0, {-0.25, 0.0}}, {{0, -1, 0}}, on(1)));
    World world = make_world(scene, Method::pinch);
    run(scene, world, 240);
    EXPECT_NEAR(world.angle[0], speed, 1e-12 * speed);
    EXPECT_NEAR(world.position[1].y(), -2.0 + 0.25 * speed, 1e-12);
  }
}

TEST(MotorLimits, SweepsHoldWhatHasNoLimit) {
  for (const double limit : {infinity, 30.0}) {
    Scene scene = winch(1.0, 2.0, limit);
    for (Body& body : scene.bodies) body.cable_friction = 0.3;
    Configuration sweeps = Method::pinch;
    sweeps.solver = Solver::iterative;
    World world = make_world(scene, sweeps);
    Workspace work;
    for (int i = 0; i < 240; ++i) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    EXPECT_NEAR(world.angular_velocity[0], 2.0, 1e-9) << limit;
  }
}

TEST(MotorLimits, MustBePositive) {
  for (const double limit : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW(make_world(winch(1.0, 1.0, limit), Method::pinch), SceneError) << limit;
  }
}

}  // namespace
}  // namespace pinchlab::testing
