// SPDX-License-Identifier: GPL-3.0-or-later
// The World is all of the state: workspaces come and go, copies are put back, and no bit changes.

#include <gtest/gtest.h>

#include <cmath>

#include "demos/scenes/library.h"
#include "sim/cable/cable.h"
#include "sim/outline.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr int scenes = seeds_of(40), steps = 480;

Configuration configuration_of(int seed) {
  constexpr const char* names[] = {"pinch", "pinch", "pinch_no_contact", "cable", "thesis"};
  return *configuration_from_string(names[seed % 5]);
}

TEST(State, AClearedWorkspaceChangesNoBit) {
  for (int seed = 0; seed < scenes; ++seed) {
    const Scene scene = random_scene(seed);
    EXPECT_TRUE(is_all_state(scene, configuration_of(seed), steps)) << seed;
  }
}

// Pinches of pulleys that only turn are kept while one disc falls on to a wall of its own, and
// found anew once another falls on to them.
TEST(State, PinchesAreKeptWhereNothingMoves) {
  Scene scene = stress_scene(3, pinched_spacing);
  Body disc;
  disc.radius = 0.3;
  disc.name = "far";
  disc.position = {-100.0, 0.5};
  scene.bodies.push_back(disc);
  disc.name = "near";
  disc.position = scene.bodies.front().position + Vec2(0.1, 3.0);
  scene.bodies.push_back(disc);
  Wall slab;
  slab.a = {-101.0, 0.0};
  slab.b = {-99.0, 0.0};
  scene.walls.push_back(slab);
  for (const bool sleep : {false, true}) {
    Configuration configuration = Method::pinch;
    configuration.sleep = sleep;
    EXPECT_TRUE(is_all_state(scene, configuration, 400)) << sleep;
  }
}

// A stage that tries a step, of another length even, and goes back to where it was.
TEST(State, AStepThatIsTakenBackLeavesNothing) {
  for (int seed = 0; seed < scenes; ++seed) {
    const Scene scene = random_scene(seed);
    World straight = make_world(scene, configuration_of(seed)), tried = straight;
    Workspace straight_work, work;
    for (int i = 0; i < steps; ++i) {
      const World saved = tried;
      tried.step_length *= i % 2 == 0 ? 1.0 : 0.3;
      for (int k = 0; k <= i % 3; ++k) ASSERT_EQ(step(scene, tried, work), StepStatus::ok);
      velocities_now(scene, tried, work);
      tried = saved;
      ASSERT_EQ(step(scene, tried, work), StepStatus::ok);
      ASSERT_EQ(step(scene, straight, straight_work), StepStatus::ok);
      ASSERT_TRUE(same_state(straight, tried)) << "seed " << seed << ", step " << i;
    }
  }
}

// A try moves a body round another, by a third of a turn at a time, and is taken back: the span
// that joins them, and what lies on the pulley, are as they were.
TEST(State, WhatIsTakenBackHasNotTurned) {
  Scene scene;
  scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 0.0, 0.0, 0.3, 1.0));
  scene.bodies.push_back(body("load", BodyKind::free, 0.35, -2.0, 0.1, 1.0));
  scene.cables.push_back(cable(at(-1.0, -1.0), {{0, -1, 0}}, on(1)));
  World world = make_world(scene, Method::pinch);
  run(scene, world, 1);
  const std::vector<CableState> cables = world.cables;
  const Vec2 start = world.position[1];
  for (int k = 1; k <= 4; ++k) {
    const double angle = 2.0 * k * M_PI / 3.0;
    world.position[1] = start.norm() * Vec2(std::cos(angle), std::sin(angle));
    update_cable(world, world.cables[0], k == 1, true);
  }
  world.position[1] = start;
  update_cable(world, world.cables[0], false, true);
  for (std::size_t i = 1; i < cables[0].links.size(); ++i) {
    EXPECT_EQ(world.cables[0].segments[i].alpha, cables[0].segments[i].alpha) << i;
    EXPECT_EQ(world.cables[0].links[i].wrap, cables[0].links[i].wrap) << i;
  }
}

TEST(State, OneWorkspaceServesAnyWorld) {
  const Scene one = random_scene(1), other = random_scene(2);
  World a = make_world(one, Method::pinch), b = make_world(other, Method::pinch);
  World a_alone = a, b_alone = b;
  Workspace shared, a_work, b_work;
  for (int i = 0; i < 100; ++i) {
    step(one, a, shared);
    step(other, b, shared);
    step(one, a_alone, a_work);
    step(other, b_alone, b_work);
    ASSERT_TRUE(same_state(a, a_alone) && same_state(b, b_alone)) << i;
  }
}

// Polygons that spin fast have contacts by where they get to, not by how old lists of pairs are.
TEST(State, SpinningPolygonsPartTheSameWithANewWorkspace) {
  Scene scene;
  for (const double side : {-1.0, 1.0}) {
    Body body = build::body(side < 0.0 ? "l" : "r", BodyKind::free, 0.165 * side, 0.0, 0.1, 1.0);
    make_polygon(body, {{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}, 0.0);
    body.velocity = {0.3 * side, 0.0};
    body.angular_velocity = -200.0 * side;
    body.restitution = 0.5;
    scene.bodies.push_back(body);
  }
  scene.walls.push_back({Vec2(-3.0, -1.0), Vec2(0.0, -1.0), 0.0, 0.0});
  World kept = make_world(scene, Method::pinch), cleared = kept;
  Workspace work;
  for (int i = 0; i < 400; ++i) {
    Workspace fresh;
    ASSERT_EQ(step(scene, kept, work), StepStatus::ok);
    ASSERT_EQ(step(scene, cleared, fresh), StepStatus::ok);
    ASSERT_TRUE(same_state(kept, cleared)) << i;
  }
}

}  // namespace
}  // namespace pinchlab::testing
