// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the simulator's tests share.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "demos/scenes/build.h"
#include "sim/diagnostics.h"
#include "sim/scene_error.h"
#include "sim/step.h"
#include "sim/world.h"
#include "tests/base/message_of.h"

namespace pinchlab::testing {

using build::at;
using build::body;
using build::cable;
using build::load_chain;
using build::on;
using test::message_of;

constexpr double g = 9.81;  // m/s^2, the default gravity

/// The method, with lengths, gaps and energy measured at each step.
inline Configuration measured(Method method = Method::pinch) {
  Configuration configuration = method;
  configuration.diagnostics = true;
  return configuration;
}

inline void run(const Scene& scene, World& world, int steps) {
  Workspace work;
  for (int i = 0; i < steps; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
  }
}

/// Moves on to that time (s), never by the fallback.
inline void run_to(const Scene& scene, World& world, double time) {
  Workspace work;
  while (world.time() < time - 0.5 * world.step_length) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
  }
  EXPECT_EQ(world.diagnostics.fallbacks, 0);
}

/// The scene, by that many steps a frame, after so many seconds.
inline World after(Scene scene, int steps_per_frame, double seconds) {
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, measured());
  run_to(scene, world, seconds);
  return world;
}

/// The largest of each over a run. Energies in J, lengths in m.
struct Extremes {
  double energy_gain = -infinity;  // over that at the start
  double kinetic = 0.0;
  double stretch = 0.0;
  double gap_violation = 0.0;
};

inline Extremes play(const Scene& scene, World& world, double seconds) {
  Extremes most;
  Workspace work;
  double start = 0.0;
  for (int i = 0; world.time() < seconds; ++i) {
    EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    const Diagnostics& d = world.diagnostics;
    if (i == 0) start = d.energy;
    most.energy_gain = std::max(most.energy_gain, d.energy - start);
    most.kinetic = std::max(most.kinetic, kinetic_energy(world));
    most.stretch = std::max(most.stretch, d.largest_stretch);
    most.gap_violation = std::max(most.gap_violation, d.largest_gap_violation);
    if (::testing::Test::HasFailure()) break;
  }
  return most;
}

inline double height_of_ball(int i) {  // m, of its lowest point at time 0
  return 0.5 + 0.4 * std::fmod(0.6180339887 * i, 1.0);
}

/// Balls side by side that fall on one floor and rebound by `restitution`.
inline Scene balls(int count, double (*height)(int), double restitution = 0.8) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    Body ball = body(fmt::format("ball {}", i), BodyKind::free, i, 0.1 + height(i), 0.1, 1.0);
    ball.restitution = restitution;
    scene.bodies.push_back(ball);
  }
  scene.walls.push_back({Vec2(-1.0, 0.0), Vec2(count + 1.0, 0.0), 0.5, 0.0});
  scene.steps_per_frame = 1;
  return scene;
}

/// A pendulum of 1 m, held out level, on a peg at x.
inline void add_pendulum(Scene& scene, double x) {
  scene.bodies.push_back(body(fmt::format("bob {}", x), BodyKind::free, x + 1.0, 0.0, 0.1, 1.0));
  Cable rope = cable(at(x, 0.0), {}, on(static_cast<int>(scene.bodies.size()) - 1));
  scene.cables.push_back(rope);
}

}  // namespace pinchlab::testing
