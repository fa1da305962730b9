// SPDX-License-Identifier: GPL-3.0-or-later
// Linkages of which joints or cables hold what others hold as well, that come to their dead
// centres, and whose parts spin or are light beside what they carry.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/at.h"
#include "sim/joints.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double g = 9.81;  // m/s^2

/// A platform of 10 kg that hangs level on parallel bars of 1 m, or ropes, let go at 40 degrees:
/// all of them hold it, and two would do.
Scene platform(int holders, bool ropes) {
  Scene scene;
  const double angle = 40.0 * std::numbers::pi / 180.0;
  const Vec2 swung(std::sin(angle), -std::cos(angle));
  scene.bodies.push_back(body("platform", BodyKind::free, swung.x(), swung.y(), 1.0, 10.0));
  make_polygon(scene.bodies[0], {{-1, -0.05}, {1, -0.05}, {1, 0.05}, {-1, 0.05}}, 0.0);
  for (int i = 0; i < holders; ++i) {
    const Vec2 at_level(-0.8 + 1.6 * i / (holders - 1), 0.0);
    if (ropes) {
      scene.cables.push_back(cable({-1, at_level}, {}, {0, at_level}, 0.01));
    } else {
      add_bar(scene, "bar " + std::to_string(i), {-1, at_level}, {0, at_level});
    }
  }
  return scene;
}

/// rad, of a pendulum of that length (m) after `time` (s), let go at `angle`.
double swung_to(double angle, double length, double time) {
  constexpr int steps = 20000;
  const double h = time / steps;
  double turning = 0.0;
  for (int k = 0; k < steps; ++k) {  // of fourth order: Forest and Ruth
    const double a = 1.0 / (2.0 - std::cbrt(2.0));
    const double ways[] = {0.5 * a, 0.5 * (1.0 - a), 0.5 * (1.0 - a), 0.5 * a};
    const double kicks[] = {a, 1.0 - 2.0 * a, a, 0.0};
    for (int i = 0; i < 4; ++i) {
      angle += h * ways[i] * turning;
      turning -= h * kicks[i] * g / length * std::sin(angle);
    }
  }
  return angle;
}

// It swings as a parallelogram, without tilting: its middle as a pendulum of the bars' length. What
// repeats others asks for the same as they do, but for round-off, which must not grow.
TEST(Linkage, APlatformOnMoreBarsThanItNeedsSwingsOn) {
  const double exact = std::sin(swung_to(40.0 * std::numbers::pi / 180.0, 1.0, 1.5));
  for (const auto& [holders, ropes] : {std::pair{3, false}, {3, true}, {4, true}}) {
    for (const int steps : {4, 64, 192}) {
      const World world = after(platform(holders, ropes), steps, 1.5);
      const double error = 6e-4 / (steps * steps) + 1e-9;  // m
      EXPECT_NEAR(world.position[0].x(), exact, error) << holders << ropes << steps;
      EXPECT_NEAR(world.angle[0], 0.0, 1e-11) << holders << ropes << steps;
      EXPECT_EQ(world.diagnostics.fallbacks, 0) << holders << ropes << steps;
    }
  }
}

// A square of discs and bars with both diagonals, of which one is too many, spins freely.
TEST(Linkage, ASquareWithBothDiagonalsKeepsSpinning) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  const Vec2 corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int i = 0; i < 4; ++i) {
    scene.bodies.push_back(
        body(std::to_string(i), BodyKind::free, corners[i].x(), corners[i].y(), 0.05, 1.0));
    scene.bodies.back().velocity = 2.0 * left(Vec2(corners[i] - Vec2(0.5, 0.5)));
  }
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < i; ++k) add_bar(scene, fmt::format("{}{}", i, k), on(i), on(k));
  }
  for (const int steps : {4, 64, 256}) {
    const World world = after(scene, steps, 1.5);
    EXPECT_NEAR(world.diagnostics.energy, 4.0, 1e-9) << steps;
  }
}

/// A rod on a hinge in the world, with a bar from the hinge to the rod's tip that it does not need,
/// and a spring that pulls the tip, listed in one order or the other. It swings through the
/// vertical, where the bar is parallel to one of the hinge's own.
Scene braced_pendulum(bool brace_first) {
  Scene scene;
  const double angle = -0.5;
  const Vec2 tip = Vec2(std::sin(angle), -std::cos(angle));
  scene.bodies.push_back(body("rod", BodyKind::free, 0.5 * tip.x(), 0.5 * tip.y(), 0.05, 1.0));
  scene.bodies[0].inertia = 1.0 / 12.0;
  for (const bool brace : {brace_first, !brace_first}) {
    if (brace) {
      add_bar(scene, "brace", {-1, {0.0, 0.0}}, {0, 0.5 * tip});
    } else {
      add_hinge(scene, "pin", 0, -1, {0.0, 0.0});
    }
  }
  add_spring(scene, "spring", {-1, {0.0, 1.0}}, {0, 0.5 * tip}, 50.0, 0.0, 0.0);
  return scene;
}

// It stopped dead beside the vertical, where the rows' order had the brace tell of the hinge what
// round-off leaves of it there. Either order is of second order.
TEST(Linkage, ABarBesideAHingeMayBeListedBeforeItOrBehind) {
  for (const int steps : {1, 4, 64}) {
    const World first = after(braced_pendulum(true), steps, 3.0);
    const World last = after(braced_pendulum(false), steps, 3.0);
    EXPECT_NEAR(first.angle[0], last.angle[0], 1e-3 / (steps * steps)) << steps;
    EXPECT_GT(first.diagnostics.energy, -4.31) << steps;  // of -4.3045 J
    EXPECT_LT(first.diagnostics.energy, -4.30) << steps;
  }
}

// Two bars at right angles also keep their lengths beyond the corner that they make: as far off as
// the discs were thick a hinge flipped there, for good, where a blow met it at a coarse step.
TEST(Linkage, AHingeOfThinRodsDoesNotFlip) {
  for (const int steps : {1, 2, 4}) {
    Scene scene;
    scene.steps_per_frame = steps;
    const Vec2 elbow(0.4, 0.0);
    for (const double x : {0.2, 0.6}) {
      scene.bodies.push_back(body(x < 0.5 ? "upper" : "lower", BodyKind::free, x, 0.0, 1e-3, 1.0));
      scene.bodies.back().inertia = 0.16 / 12.0;
    }
    add_hinge(scene, "shoulder", 0, -1, {0.0, 0.0});
    add_hinge(scene, "elbow", 1, 0, elbow);
    scene.walls.push_back({{-2.0, -0.37}, {2.0, -0.37}, 0.5, 0.0});
    World world = make_world(scene, measured());
    Workspace work;
    for (int i = 0; i < 180 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      const auto place = [&](int b, double along) {
        const double angle = world.angle[index(b)];
        return Vec2(world.position[index(b)] + along * Vec2(std::cos(angle), std::sin(angle)));
      };
      ASSERT_LT((place(0, 0.2) - place(1, -0.2)).norm(), 1e-10) << steps << " " << i;
    }
  }
}

/// Two wheels on axles, cranks of which are coupled by rods as long as the axles are apart, a
/// quarter of a turn from each other: at each dead centre of one the other holds.
Scene coupled_wheels(double phase, double turning) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  for (const double x : {0.0, 1.2}) {
    scene.bodies.push_back(
        body(x == 0.0 ? "left" : "right", BodyKind::fixed_axle, x, 0.0, 0.3, 5.0));
    scene.bodies.back().angular_velocity = turning;
  }
  for (const double ahead : {0.0, 0.5 * std::numbers::pi}) {
    const Vec2 pin = 0.2 * Vec2(std::cos(phase + ahead), std::sin(phase + ahead));
    add_bar(scene, ahead == 0.0 ? "rod" : "rod ahead", {0, pin}, {1, pin});
  }
  return scene;
}

// They turn on evenly, whether a step ends just at a dead centre (0.1 rad at 1 rad/s) or beside it.
TEST(Linkage, CouplingRodsPassTheirDeadCentres) {
  for (const int steps : {1, 4, 16, 64}) {
    const World met = after(coupled_wheels(-0.1, 1.0), steps, 0.5);
    EXPECT_NEAR(met.angle[0], 0.5, 1e-9) << steps;
    EXPECT_NEAR(met.angular_velocity[1], 1.0, 1e-9) << steps;
  }
  for (int i = 0; i < 12; ++i) {
    const double turning = 2.0 + 0.3 * i;
    const World world = after(coupled_wheels(0.37 * i, turning), 64, 4.0);
    EXPECT_NEAR(world.angle[0], 4.0 * turning, 1e-6) << i;
    EXPECT_NEAR(world.angular_velocity[1], turning, 1e-6) << i;
  }
}

// An arm that two springs hold straight, and at its end a wheel that spins: the arm stands, in
// whichever order the hinge names the two.
TEST(Linkage, AWheelSpinsOnAnArmThatStands) {
  for (const bool wheel_first : {false, true}) {
    Scene scene;
    scene.gravity = Vec2::Zero();
    scene.bodies.push_back(body("arm", BodyKind::free, 0.15, 0.0, 0.15, 0.3));
    scene.bodies.push_back(body("wheel", BodyKind::free, 0.3, 0.0, 0.05, 0.5));
    scene.bodies[1].angular_velocity = 60.0;
    add_hinge(scene, "axle", 0, -1, {0.0, 0.0});
    add_hinge(scene, "pin", wheel_first ? 1 : 0, wheel_first ? 0 : 1, {0.3, 0.0});
    for (const double y : {-0.6, 0.6}) {
      add_spring(scene, y < 0.0 ? "low" : "high", on(1), {-1, {0.8, y}}, 3000.0, 0.5, 0.0);
    }
    for (const int steps : {1, 4, 16}) {
      const World world = after(scene, steps, 1.0);
      EXPECT_NEAR(world.angle[0], 0.0, 1e-9) << wheel_first << steps;
      EXPECT_NEAR(world.angular_velocity[1], 60.0, 1e-9) << wheel_first << steps;
    }
  }
}

// A light arm carries a wheel of seventy times its mass, on a hinge: it swings as the pendulum that
// it is, and keeps its energy.
TEST(Linkage, ALightArmSwingsAHeavyWheel) {
  Scene scene;
  scene.bodies.push_back(body("arm", BodyKind::free, 0.15, 0.0, 0.15, 0.3));
  scene.bodies.push_back(body("wheel", BodyKind::free, 0.3, 0.0, 0.1, 20.0));
  scene.bodies[1].cable_friction = infinity;
  add_hinge(scene, "axle", 0, -1, {0.0, 0.0});
  add_hinge(scene, "pin", 0, 1, {0.3, 0.0});
  // The wheel does not turn: I = I_arm + (m_arm / 4 + m_wheel) l^2, and its weight's lever
  // (m_arm / 2 + m_wheel) l.
  const double l = 0.3, own = inertia_of(scene.bodies[0]);
  const double inertia = own + (0.3 / 4.0 + 20.0) * l * l;
  const double length = inertia / ((0.3 / 2.0 + 20.0) * l);
  const double exact = swung_to(0.5 * std::numbers::pi, length, 1.0) - 0.5 * std::numbers::pi;
  for (const int steps : {1, 2, 4, 16}) {
    const World world = after(scene, steps, 1.0);
    EXPECT_NEAR(world.angle[0], exact, 0.1 / (steps * steps)) << steps;
  }
}

}  // namespace
}  // namespace pinchlab::testing
