// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/bare_pass.h"

#include <gtest/gtest.h>

#include "demos/scenes/library.h"
#include "sim/step.h"

namespace pinchlab::experiments {
namespace {

// The yardstick must do the work that it stands for: one step of the simulator, without gravity and
// with all segments taut, gives the same tensions and velocities.
TEST(BarePass, SolvesTheSystemOfAStep) {
  Scene scene = stress_scene(5, free_spacing);
  scene.gravity = Vec2::Zero();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    scene.bodies[b].angular_velocity = 0.01 * (static_cast<double>(b % 7) - 3.0);  // rad/s
  }
  Configuration configuration = Method::pinch;
  configuration.sleep = false;
  World world = make_world(scene, configuration);
  Workspace work;
  ASSERT_EQ(step(scene, world, work), StepStatus::ok);  // its kick is half as long
  BarePass pass(scene, world);
  pass.step();
  ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  const CableState& cable = world.cables.front();
  ASSERT_EQ(pass.rows.size(), 21U);
  double least = infinity, greatest = 0.0;
  for (std::size_t s = 1; s < cable.segments.size(); ++s) {
    const double tension = pass.rows[s - 1].impulse / world.step_length;
    EXPECT_NEAR(tension, cable.segments[s].tension, 1e-9 * tension) << s;
    least = std::min(least, tension);
    greatest = std::max(greatest, tension);
  }
  EXPECT_GT(greatest - least, 1.0);  // N: not all the same by symmetry
  // The simulator rounds materials by up to 2^-46 of the cable's (elastic.cpp), and so either
  // tension on a body by that share of its segment's.
  const double share = 0x1p-46 * cable.length / cable.segments[1].rest_length;
  const double rounding = 2.0 * share * greatest * world.step_length;  // N s
  for (std::size_t i = 1; i + 1 < cable.links.size(); ++i) {
    const auto b = static_cast<std::size_t>(cable.links[i].body);
    const double turned = rounding * cable.links[i].radius / inertia_of(scene.bodies[b]);
    EXPECT_LT(turned, 1e-11);
    EXPECT_NEAR(pass.bodies[i].angular_velocity, world.angular_velocity[b], turned) << b;
  }
}

// Free bodies at its ends too.
TEST(BarePass, PullsTheWeightsOfAChain) {
  Scene scene = chain_scene(5);
  scene.gravity = Vec2::Zero();
  scene.bodies[0].velocity = {0.0, -0.3};
  World world = make_world(scene, Method::pinch);
  Workspace work;
  ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  BarePass pass(scene, world);
  pass.bodies.front().velocity += Vec2(0.0, -0.1);
  world.velocity[0] += Vec2(0.0, -0.1);
  pass.step();
  ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  EXPECT_NEAR(pass.bodies.front().velocity.y(), world.velocity[0].y(), 1e-9);
  EXPECT_NEAR(pass.bodies.back().velocity.y(), world.velocity[1].y(), 1e-9);
  EXPECT_GT(world.velocity[1].y(), 0.1);
}

}  // namespace
}  // namespace pinchlab::experiments
