// SPDX-License-Identifier: GPL-3.0-or-later
// Drag and dampers, weak and strong, against closed forms.

#include <array>

#include "sim/joints.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// A body of 2 kg and radius 0.5 m that is thrown, spins and is turned by 0.25 N m.
Scene thrown(double linear_drag, double angular_drag) {
  Scene scene;
  Body disc = body("disc", BodyKind::free, 0.0, 0.0, 0.5, 2.0);
  disc.velocity = {3.0, 1.0};
  disc.angular_velocity = 2.0;
  disc.torque = 0.25;
  disc.linear_drag = linear_drag;
  disc.angular_drag = angular_drag;
  scene.bodies.push_back(disc);
  return scene;
}

/// m (or rad) after t seconds from speed v under an acceleration a and the drag c: with u = a / c,
/// x = u t + (v - u) (1 - e^(-c t)) / c.
double gone(double v, double a, double c, double t) {
  const double terminal = a / c;
  return terminal * t - (v - terminal) * std::expm1(-c * t) / c;
}

/// How far a body is off its exact motion after a second, in x, y and angle.
std::array<double, 3> error(double linear_drag, double angular_drag, int steps_per_frame) {
  Scene scene = thrown(linear_drag, angular_drag);
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, measured());
  run(scene, world, 60 * steps_per_frame);
  const double inertia = 0.5 * 2.0 * 0.25;
  return {std::abs(world.position[0].x() - gone(3.0, 0.0, linear_drag, 1.0)),
          std::abs(world.position[0].y() - gone(1.0, -g, linear_drag, 1.0)),
          std::abs(world.angle[0] - gone(2.0, 0.25 / inertia, angular_drag, 1.0))};
}

TEST(Drag, IsOfSecondOrder) {
  const auto coarse = error(1.5, 4.0, 4), fine = error(1.5, 4.0, 8);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(coarse[i], 2e-5);
    EXPECT_NEAR(coarse[i] / fine[i], 4.0, 0.05) << i;
  }
}

// However strong, drag brings a body to its terminal velocity and never turns it round: a step too
// long to follow that (c h > 2) takes what speed there was at once. What it goes by less is v h at
// most.
TEST(Drag, NeverTurnsABodyRound) {
  for (const double drag : {100.0, 479.0, 481.0, 1e3, 1e4}) {
    for (const int steps_per_frame : {1, 4, 16}) {
      Scene scene = thrown(drag, drag);
      scene.gravity = {0.0, 0.0};
      scene.bodies[0].torque = 0.0;
      scene.steps_per_frame = steps_per_frame;
      World world = make_world(scene, measured());
      Workspace work;
      Vec2 last = world.position[0];
      double last_angle = 0.0;
      for (int i = 0; i < 30; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok);
        ASSERT_GE(world.position[0].x(), last.x()) << drag << ", step " << i;
        ASSERT_GE(world.position[0].y(), last.y()) << drag << ", step " << i;
        ASSERT_GE(world.angle[0], last_angle) << drag << ", step " << i;
        last = world.position[0];
        last_angle = world.angle[0];
      }
      EXPECT_NEAR(last.x(), 3.0 / drag, 3.0 * world.step_length) << drag;
    }
  }
}

TEST(Drag, StrongDragKeepsTheTerminalVelocity) {
  for (const int steps_per_frame : {1, 4, 16}) {
    const auto off = error(1e4, 1e4, steps_per_frame);
    EXPECT_LT(off[1], 2.0 / 60.0 / steps_per_frame * g / 1e4 + 1e-4);
  }
}

/// 1 kg on a rail, at a spring as long as it wants to be.
Scene on_a_spring(double stiffness, double damping) {
  Scene scene;
  scene.gravity = {0.0, 0.0};
  scene.bodies.push_back(body("cart", BodyKind::rail, 1.0, 0.0, 0.1));
  scene.bodies[0].rail_axis = {1.0, 0.0};
  add_spring(scene, "spring", at(0.0, 0.0), on(0), stiffness, 1.0, damping);
  return scene;
}

TEST(Drag, AStrongDamperNeverTurnsItsBodyRound) {
  for (const double damping : {300.0, 1e3, 1e4, 1e6}) {
    for (const int steps_per_frame : {1, 4, 16}) {
      Scene scene = on_a_spring(0.1, damping);
      scene.bodies[0].velocity = {1.0, 0.0};
      scene.steps_per_frame = steps_per_frame;
      World world = make_world(scene, measured());
      Workspace work;
      double last = world.position[0].x();
      for (int i = 0; i < 30; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok);
        ASSERT_GE(world.position[0].x(), last - 1e-6) << damping << ", step " << i;
        last = world.position[0].x();
      }
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
