// SPDX-License-Identifier: GPL-3.0-or-later
// A warm step allocates nothing. (The sanitizers bring allocators of their own, so they skip this.)

#include "demos/scenes/shape_scenes.h"
#include "sim/workspace.h"
#include "tests/sim/scenes.h"

#ifndef __SANITIZE_ADDRESS__

#include <algorithm>
#include <cstdlib>
#include <new>

namespace {
long allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace pinchlab::testing {
namespace {

/// The most that any configuration allocates.
long allocations_of_warm_steps(const Scene& scene) {
  long most = 0;
  Configuration three;
  three.pinch_rows = PinchRows::three;
  for (const Configuration& configuration :
       {Configuration(Method::pinch), three, thesis_configuration()}) {
    World world = make_world(scene, configuration);
    Workspace work;
    for (int i = 0; i < 100; ++i) EXPECT_EQ(step(scene, world, work), StepStatus::ok);
    const long before = allocations;
    for (int i = 0; i < 100; ++i) EXPECT_EQ(step(scene, world, work), StepStatus::ok);
    most = std::max(most, allocations - before);
  }
  return most;
}

TEST(Allocation, NoneOnceWarmWithRollingCables) {
  EXPECT_EQ(allocations_of_warm_steps(load_chain(21, 3.0, 2.0, 1.0)), 0);
}

TEST(Allocation, NoneOnceWarmWithSlippingCables) {
  EXPECT_EQ(allocations_of_warm_steps(load_chain(21, 3.0, 2.0, 1.0, 0.05)), 0);
}

// A heavy rope that slips on a block that it carries, and on a pulley.
TEST(Allocation, NoneOnceWarmWithSleeves) {
  for (const double mu : {0.0, 0.1, 10.0}) {
    Scene scene = build::heavy_tackle(4);
    scene.bodies[0].cable_friction = scene.bodies[2].cable_friction = mu;
    World world = make_world(scene, Method::pinch);
    Workspace work;
    for (int i = 0; i < 40; ++i) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    const long before = allocations;
    for (int i = 0; i < 40; ++i) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    EXPECT_EQ(allocations - before, 0) << mu;
  }
}

TEST(Allocation, NoneOnceWarmWithPinches) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 5.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, 0.85, 0.25, 2.0));
  scene.bodies.push_back(body("left", BodyKind::free, -0.55, -2.0, 0.2, 1.0));
  scene.bodies.push_back(body("right", BodyKind::free, 0.55, -2.0, 0.2, 1.0));
  scene.bodies[1].driven_angular_velocity = -1.0;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(3)));
  EXPECT_EQ(allocations_of_warm_steps(scene), 0);
}

TEST(Allocation, NoneOnceWarmWithNodesThatAdapt) {
  const Scene scene = build::drawn_taut(31, 4, 2e-3);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  for (int i = 0; i < 700; ++i) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  const long before = allocations;
  const std::int64_t changes = world.diagnostics.node_changes;
  for (int i = 0; i < 500; ++i) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GT(world.diagnostics.node_changes, changes + 50);
}

// Each ball rebounds at times of its own, so that most steps are divided part by part, as often as
// events fall into them.
TEST(Allocation, NoneOnceWarmWithStepsThatAreDivided) {
  Scene scene = balls(30, height_of_ball, 1.0);
  add_pendulum(scene, 50.0);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  for (int i = 0; i < 300; ++i) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  int divided = 0;
  const std::int64_t events = world.diagnostics.events;
  for (int i = 0; i < 600; ++i) {
    const long before = allocations;
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    ASSERT_EQ(allocations - before, 0) << "step " << world.step;
    if (work.neighbourhoods.list.size() > 1) ++divided;
  }
  EXPECT_GT(divided, 100);
  EXPECT_GT(world.diagnostics.events, events + 300);
}

}  // namespace
}  // namespace pinchlab::testing

#endif
