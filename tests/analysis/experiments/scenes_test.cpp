// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/element_counts.h"
#include "demos/scenes/library.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/step.h"

namespace pinchlab::experiments {

void PrintTo(const ElementCounts& c, std::ostream* out) {
  *out << c.bodies << " bodies, " << c.non_transitional << " non-transitional, " << c.transitional
       << " transitional, " << c.contacts << " contacts, " << c.joints << " joints, " << c.segments
       << " segments";
}

namespace {

Configuration awake(Configuration configuration) {
  configuration.sleep = false;
  return configuration;
}

// Rows of the thesis' Tables 5.1 and 5.2 as printed.
struct PrintedCounts {
  int load;
  ElementCounts pinched, free;
};
const PrintedCounts printed[] = {
    {1, {4, 2, 2, 3, 10, 9}, {4, 0, 0, 0, 6, 5}},
    {2, {8, 6, 4, 7, 22, 21}, {8, 0, 0, 0, 10, 9}},
    {5, {20, 18, 10, 19, 58, 57}, {20, 0, 0, 0, 22, 21}},
    {10, {40, 38, 20, 39, 118, 117}, {40, 0, 0, 0, 42, 41}},
    {20, {80, 78, 40, 79, 238, 237}, {80, 0, 0, 0, 82, 81}},
};

TEST(StressScene, HasTheThesisElements) {
  for (const PrintedCounts& row : printed) {
    const World pinched = make_world(stress_scene(row.load, pinched_spacing), Method::pinch);
    EXPECT_EQ(count_elements(pinched), row.pinched) << "load " << row.load;
    for (const Method method : {Method::pinch, Method::cable}) {
      const World free = make_world(stress_scene(row.load, free_spacing), method);
      EXPECT_EQ(count_elements(free), row.free) << "load " << row.load;
    }
  }
}

TEST(StressScene, KeepsItsElementsAndTensionWhileItRuns) {
  for (const std::size_t n : {1UL, 5UL, 20UL, 50UL, 100UL, 200UL, 500UL, 1000UL, 2000UL}) {
    const Scene scene = stress_scene(static_cast<int>(n), pinched_spacing);
    World world = make_world(scene, awake(Method::pinch));
    Workspace work;
    for (int i = 0; i < 10; ++i)
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    const ElementCounts counts{4 * n, 4 * n - 2, 2 * n, 4 * n - 1, 12 * n - 2, 12 * n - 3};
    EXPECT_EQ(count_elements(world), counts) << "load " << n;
    EXPECT_EQ(counts.attachments(), 8 * n);
    const double expected = stress_stiffness * stress_strain;
    const CableState& cable = world.cables.front();
    for (std::size_t s = 1; s < cable.segments.size(); ++s) {
      // In a non-transitional pinch it is what the middle body takes up.
      const Segment& segment = cable.segments[s];
      const bool takes_up = segment.pinched && segment.tension < 0.5 * expected;
      EXPECT_NEAR(segment.tension, takes_up ? 0.0 : expected, 1e-6 * expected)
          << n << ", segment " << s;
    }
  }
}

// Nothing moves but what round-off of 11 km of cable makes of a chain of 8000 pulleys.
TEST(StressScene, FallsAsleepHoweverLarge) {
  const Scene scene = stress_scene(2000, pinched_spacing);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  while (world.time() < 0.6) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    for (const double omega : world.angular_velocity) ASSERT_LT(std::abs(omega), 1e-9);
  }
  EXPECT_TRUE(std::ranges::all_of(work.parts.list, &Part::asleep));
}

TEST(PinchDetectionScene, PressesTheCableOnlyWhereItShould) {
  for (const bool pinching : {false, true}) {
    for (const bool other : {false, true}) {
      for (const std::size_t n : {1UL, 2UL, 20UL}) {
        const Scene scene = pinch_detection_scene(static_cast<int>(n), pinching, other);
        World world = make_world(scene, awake(Method::pinch));
        Workspace work;
        for (int i = 0; i < 60; ++i)
          ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
        const ElementCounts counts = count_elements(world);
        EXPECT_EQ(counts.bodies, 2 * n + n * (pinching ? 1 : 0) + n * (other ? 1 : 0));
        EXPECT_EQ(counts.non_transitional, pinching ? n : 0);
        EXPECT_EQ(counts.transitional, 0U);
        const auto touching = std::count_if(world.contacts.begin(), world.contacts.end(),
                                            [](const Contact& c) { return c.touching; });
        EXPECT_EQ(static_cast<std::size_t>(touching), n * (pinching ? 1 : 0) + n * (other ? 1 : 0));
      }
    }
  }
}

TEST(ChainScene, FallsAsItsMassesSay) {
  const Scene scene = chain_scene(81);
  World world = make_world(scene, awake(Method::pinch));
  Workspace work;
  const int steps = 240;
  for (int i = 0; i < steps; ++i)
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
  // Discs of 0.1 kg: their surfaces, w inside of the cable's centre line, roll at its speed.
  const double ratio = 0.5 / 0.55;
  const double inertia = 1999.0 + 81 * 0.05 * ratio * ratio;
  const double expected = 0.5 * 9.81 / inertia * world.time() * world.time();
  EXPECT_NEAR(-3.0 - world.position[0].y(), expected, 1e-9);
}

TEST(SwingingScene, SwingsForEverWithoutContactsAndPinches) {
  const Scene scene = swinging_scene(5);
  World world = make_world(scene, awake(Method::pinch));
  Workspace work;
  double fastest = 0.0;
  for (int i = 0; i < 24000; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    if (i >= 23000) fastest = std::max(fastest, world.velocity[0].norm());
  }
  EXPECT_NEAR(fastest, 0.5, 0.01);
  EXPECT_TRUE(world.contacts.empty());
  EXPECT_EQ(count_elements(world), (ElementCounts{6, 0, 0, 0, 7, 6}));
}

TEST(DisconnectedScene, SomeSwingAndOthersHangStill) {
  const Scene scene = disconnected_scene(20, 3);
  World world = make_world(scene, awake(Method::pinch));
  Workspace work;
  for (int i = 0; i < 240; ++i)
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
  for (std::size_t b = 1; b < scene.bodies.size(); b += 2) {
    if (b < 6) {
      EXPECT_GT(world.velocity[b].norm(), 1e-3) << b;
    } else {
      EXPECT_LT(world.velocity[b].norm(), 1e-9) << b;
    }
  }
}

// Thesis 7.1: cables at rest cost nothing, and those that move do not notice.
TEST(DisconnectedScene, SleepsWithoutDisturbingWhatMoves) {
  const int moving = 3, count = 20;
  const Scene scene = disconnected_scene(count, moving);
  World with = make_world(scene, Method::pinch), without = make_world(scene, awake(Method::pinch));
  Workspace with_work, without_work;
  for (int i = 0; i < 480; ++i) {
    ASSERT_EQ(step(scene, with, with_work), StepStatus::ok) << with.failure;
    ASSERT_EQ(step(scene, without, without_work), StepStatus::ok) << without.failure;
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (b < 2 * moving) {
      EXPECT_EQ(with.position[b], without.position[b]) << b;
      EXPECT_EQ(with.velocity[b], without.velocity[b]) << b;
      EXPECT_EQ(with.angle[b], without.angle[b]) << b;
    } else {
      EXPECT_LT((with.position[b] - without.position[b]).norm(), 1e-12) << b;
    }
  }
  int asleep = 0;
  for (std::size_t c = 0; c < scene.cables.size(); ++c) asleep += is_idle(with_work.parts, c);
  EXPECT_EQ(asleep, count - moving);
}

}  // namespace
}  // namespace pinchlab::experiments
