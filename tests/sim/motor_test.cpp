// SPDX-License-Identifier: GPL-3.0-or-later
// Motors that follow a table of straight lines.

#include "sim/promises.h"
#include "sim/scene_error.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

const std::vector<MotorPoint> table = {{0.1, 1.0}, {0.3, 5.0}, {0.35, 5.0}, {0.9, -2.0}};

/// Integral of the table from 0 to t.
double integral(double t) {
  return t * mean_drive(table, 0.0, t);
}

/// A winch with a table and a load on its rope.
Scene winch() {
  Scene scene;
  const double r = 0.5, w = 0.05;
  scene.bodies.push_back(body("winch", BodyKind::fixed_axle, 0.0, 0.0, r, 2.0));
  scene.bodies.push_back(body("load", BodyKind::free, r + w, -3.0, 0.2, 4.0));
  Cable rope = cable({0, {0.0, r + w}}, {{0, -1, 1}}, on(1), w);
  scene.cables.push_back(rope);
  scene.bodies[0].motor = table;
  return scene;
}

TEST(Motor, TableIsStraightLinesBetweenItsPoints) {
  EXPECT_DOUBLE_EQ(mean_drive(table, 0.0, 0.1), 1.0);
  EXPECT_DOUBLE_EQ(mean_drive(table, 0.1, 0.3), 3.0);
  EXPECT_DOUBLE_EQ(mean_drive(table, 0.2, 0.21), 3.1);
  EXPECT_DOUBLE_EQ(mean_drive(table, 2.0, 3.0), -2.0);
  EXPECT_NEAR(integral(1.0), 0.1 * 1.0 + 0.2 * 3.0 + 0.05 * 5.0 + 0.55 * 1.5 - 0.1 * 2.0, 1e-14);
  EXPECT_DOUBLE_EQ(mean_drive({{0.5, 7.0}}, 0.0, 2.0), 7.0);
}

// The steps fall between the table's corners, and still the angle is the exact integral.
TEST(Motor, WinchTurnsAsItsTableSays) {
  for (const int steps_per_frame : {1, 4}) {
    Scene scene = winch();
    scene.steps_per_frame = steps_per_frame;
    scene.bodies[0].driven_angular_velocity = 0.0;
    World world = make_world(scene, measured());
    EXPECT_DOUBLE_EQ(world.angular_velocity[0], 1.0);
    const double y = world.position[1].y();
    Workspace work;
    for (int i = 0; i < 60 * steps_per_frame; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      ASSERT_NEAR(world.angle[0], integral(world.time()), 1e-12);
    }
    EXPECT_NEAR(world.position[1].y() - y, 0.55 * integral(1.0), 1e-9);
    EXPECT_NEAR(velocities_now(scene, world, work).angular[0], -2.0, 1e-12);
  }
}

// Torque M(t) on the winch, m g R on its rope: (I + m R^2) omega' = M(t) + ..., exactly by kicks.
TEST(Motor, TorqueOfATableDoesItsIntegralOfWork) {
  Scene scene = winch();
  World world = make_world(scene, measured());
  run(scene, world, 240);
  Workspace work;
  const double R = 0.55, inertia = 0.5 * 2.0 * 0.25 + 4.0 * R * R;
  const double omega = (integral(1.0) - 4.0 * g * R) / inertia;
  EXPECT_NEAR(velocities_now(scene, world, work).angular[0], omega, 1e-9);
}

TEST(Motor, OfATableWakesWhatSleeps) {
  Scene scene = winch();
  scene.bodies[0].driven_angular_velocity = 0.0;
  scene.bodies[0].motor = {{0.0, 0.0}, {2.0, 0.0}, {2.5, 3.0}};
  World world = make_world(scene, {});
  run(scene, world, 240 * 3);
  EXPECT_NEAR(world.angle[0], 0.5 * 0.5 * 3.0 + 0.5 * 3.0, 1e-12);
}

TEST(Motor, DrivesTheSceneForThePromises) {
  Scene scene = winch();
  World world = make_world(scene, {});
  Promises promises(scene, world);
  Workspace work;
  for (int i = 0; i < 240; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    promises.note(scene, world);
  }
  EXPECT_EQ(promises.broken(scene, world), std::vector<std::string>());
}

TEST(Motor, HasTimesInOrderAndFiniteValues) {
  const std::vector<std::vector<MotorPoint>> wrong = {{{-0.1, 1.0}},
                                                      {{1.0, 1.0}, {1.0, 2.0}},
                                                      {{1.0, 1.0}, {0.5, 2.0}},
                                                      {{0.0, infinity}},
                                                      {{std::nan(""), 1.0}}};
  for (const auto& motor : wrong) {
    Scene scene = winch();
    scene.bodies[0].motor = motor;
    EXPECT_THROW(make_world(scene, {}), SceneError);
  }
}

TEST(Motor, IsAsStrongAsItsStrongestPoint) {
  Body b;
  EXPECT_EQ(strongest_drive(b), 0.0);
  b.torque = -2.0;
  EXPECT_EQ(strongest_drive(b), -2.0);
  b.driven_angular_velocity = 3.0;
  EXPECT_EQ(strongest_drive(b), 3.0);
  b.motor = {{0.0, 0.0}, {1.0, -4.0}, {2.0, 1.0}};
  EXPECT_EQ(strongest_drive(b), -4.0);
}

}  // namespace
}  // namespace pinchlab::testing
