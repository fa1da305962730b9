// SPDX-License-Identifier: GPL-3.0-or-later
// What lengths and gaps will miss is foreseen (solve/foresight.h): to what order, where from, and
// that it changes nothing but what a step costs.

#include <gtest/gtest.h>

#include <numeric>

#include "demos/scenes/library.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

double sum(const Curvature& differences) {
  return std::accumulate(differences.begin(), differences.end(), 0.0);
}

/// A bob on a cable of 1 m that is fixed to the world, let go at 40 degrees to the vertical.
Scene pendulum() {
  Scene scene;
  scene.bodies.push_back(body("bob", BodyKind::free, std::sin(0.7), -std::cos(0.7), 0.1));
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0)));
  return scene;
}

/// Leaves nothing to foresee the next step by.
void forget(World& world) {
  for (Pace& pace : world.pace) pace = {.lag = pace.lag};
}

/// By how much the curvature of its cable is another than foreseen (m/s), at most from 1 to 1.5 s.
double missed(int steps_per_frame) {
  Scene scene = pendulum();
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, Method::pinch);
  Workspace work;
  double most = 0.0;
  while (world.time() < 1.5) {
    const double foreseen = sum(world.cables[0].segments[1].curvature);
    EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    const double came = world.cables[0].segments[1].curvature[0];
    if (world.time() > 1.0) most = std::max(most, std::abs(came - foreseen));
  }
  return most;
}

// c is h q'' / 2, and its fourth difference h^4 times a fourth derivative: h^5 in all.
TEST(Foresight, IsOfFourthOrder) {
  double before = missed(1);
  for (const int steps : {2, 4}) {
    const double now = missed(steps);
    EXPECT_GT(std::log2(before / now), 4.5) << steps;
    before = now;
  }
}

/// How far apart bodies come in two seconds with foresight and without, at most (m).
double difference(const Scene& scene) {
  World with = make_world(scene, Method::pinch), without = with;
  Workspace with_work, without_work;
  double most = 0.0;
  while (with.time() < 2.0) {
    forget(without);
    EXPECT_EQ(step(scene, with, with_work), StepStatus::ok) << with.failure;
    EXPECT_EQ(step(scene, without, without_work), StepStatus::ok) << without.failure;
    for (std::size_t b = 0; b < with.position.size(); ++b) {
      most = std::max({most, (with.position[b] - without.position[b]).norm(),
                       with.bodies[b].radius * std::abs(with.angle[b] - without.angle[b])});
    }
  }
  return most;
}

TEST(Foresight, MovesThingsAsWithoutIt) {
  for (const int pulleys : {1, 3, 21}) {
    EXPECT_LT(difference(swinging_scene(pulleys)), 1e-9) << pulleys;
  }
  Scene elastic = swinging_scene(3);
  elastic.cables[0].axial_stiffness = 1e4;
  EXPECT_LT(difference(elastic), 1e-9);
}

// Equal steps tell of one another; a step in which a ball lands tells nothing of the next.
TEST(Foresight, BeginsAnewWhereSomethingHappens) {
  Scene scene = pendulum();
  scene.bodies[0].restitution = 0.8;
  Wall wall;
  wall.a = {0.0, -3.0};
  wall.b = {0.0, -0.5};
  scene.walls.push_back(wall);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  std::int64_t events = 0, steps = 0;
  bool struck = false;
  while (world.time() < 2.0) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    const bool happened = world.diagnostics.events != events;
    events = world.diagnostics.events;
    steps = happened ? 0 : steps + 1;
    struck = struck || (happened && world.step > 10);
    const int most = static_cast<int>(Curvature{}.size());
    // After an event the velocities are those of an instant: two steps until kicks are equal.
    EXPECT_LE(world.pace[0].intervals, std::clamp<std::int64_t>(steps - 1, 0, most)) << world.step;
  }
  EXPECT_TRUE(struck);
}

// Weights on pulleys: lengths change by J v alone, and what is missed is round-off.
TEST(Foresight, HasNothingToDoOnStraightWays) {
  for (const bool straight : {true, false}) {
    const Scene scene = straight ? chain_scene(5) : swinging_scene(5);
    World world = make_world(scene, Method::pinch);
    Workspace work;
    for (int i = 0; i < 20; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      EXPECT_EQ(world.pace[0].curved, !straight && world.pace[0].intervals > 0) << i;
    }
    EXPECT_GT(world.pace[0].intervals, 0);
  }
}

// Where steps are divided by their errors, which only corrections tell, one in eight is corrected.
TEST(Foresight, MeasuresErrorsWhereTheyAreAskedFor) {
  Scene scene = swinging_scene(3);
  scene.error = 1e-2;
  World world = make_world(scene, Method::pinch);
  Workspace work;
  bool foresaw = false;
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    EXPECT_LE(world.pace[0].unmeasured, 7);
    foresaw = foresaw || world.pace[0].unmeasured == 6;
  }
  EXPECT_TRUE(foresaw);
}

}  // namespace
}  // namespace pinchlab::testing
