// SPDX-License-Identifier: GPL-3.0-or-later
// Random scenes with polygons.

#include "sim/outline.h"
#include "sim/scene_error.h"
#include "tests/sim/overlap.h"
#include "tests/sim/random.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// Polygons and discs that fall on a cable over polygons and discs with fixed axles.
Scene falling_polygons(int seed) {
  Random random(static_cast<unsigned>(seed));
  Scene scene;
  const int pulleys = 2 + random.below(3), falling = 1 + random.below(4);
  const bool slips = random.below(2) == 0;
  std::vector<Wrap> wraps;
  const auto add = [&](const std::string& name, BodyKind kind, double x, double y, double radius,
                       double mass) {
    Body b = body(name, kind, x, y, radius, mass);
    if (random.below(3) > 0) make_random_polygon(random, radius, false, b);
    b.cable_friction = slips ? random.uniform(0.0, 0.6) : infinity;
    b.restitution = random.below(3) == 0 ? random.uniform(0.0, 1.0) : 0.0;
    b.contact_friction = random.uniform(0.0, 1.0);
    scene.bodies.push_back(b);
  };
  for (int i = 0; i < pulleys; ++i) {
    add(fmt::format("pulley {}", i), random.below(2) == 0 ? BodyKind::fixed : BodyKind::fixed_axle,
        1.5 * i, -0.1 * i * (pulleys - 1 - i), random.uniform(0.3, 0.45), 1.0);
    wraps.push_back({i, -1, 0});
  }
  for (int i = 0; i < falling; ++i) {
    add(fmt::format("falling {}", i), BodyKind::free,
        random.uniform(-0.3, 1.5 * (pulleys - 1) + 0.3), 1.4 + 0.9 * i, random.uniform(0.15, 0.4),
        std::pow(10.0, random.uniform(-1.0, 1.0)));
    scene.bodies.back().angular_velocity = random.uniform(-3.0, 3.0);
  }
  const double right = 1.5 * (pulleys - 1) + 1.0;
  scene.cables.push_back(cable(at(-1.0, -1.5), wraps, at(right, -1.5), 0.04));
  scene.cables[0].slack = random.uniform(0.0, 0.5);
  scene.walls.push_back({{-10.0, -2.5}, {20.0, -2.5}, 0.5, 0.0});
  scene.walls.push_back({{-2.0, -3.0}, {-2.0, 4.0}, 0.5, 0.0});
  return scene;
}

struct Course {
  double gained = 0.0, at_play = 0.0;  // J
  double gap = 0.0, stretch = 0.0;     // m
  double overlap = -infinity;          // m
};

Course run_measured(const Scene& scene, World& world) {
  Course course;
  Workspace work;
  double start = 0.0;
  for (int i = 0; i < 90 * scene.steps_per_frame; ++i) {
    EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    if (!world.failure.empty()) break;
    const Diagnostics& d = world.diagnostics;
    if (i == 0) start = d.energy;
    course.gained = std::max(course.gained, d.energy - start);
    course.at_play = std::max(course.at_play, start - d.energy);
    course.gap = std::max(course.gap, d.largest_gap_violation);
    course.stretch = std::max(course.stretch, d.largest_stretch);
    course.overlap = std::max(course.overlap, largest_overlap(scene, world));
  }
  return course;
}

// What is counted is a share that may still fail (sim/README.md, "Limits"); energy and finiteness
// must hold in every one.
TEST(RandomCorners, StayFiniteAndMakeNoEnergy) {
  int ran = 0, squeezed = 0, stretched = 0;
  for (int seed = 0; seed < seeds_of(400); ++seed) {
    for (const int steps_per_frame : {1, 4, 16}) {
      Scene scene = falling_polygons(seed);
      scene.steps_per_frame = steps_per_frame;
      World world;
      try {
        world = make_world(scene, measured());
      } catch (const SceneError&) {  // the cable finds no way, or not over all of them
        break;
      }
      const Course course = run_measured(scene, world);
      EXPECT_LE(course.gained, 1e-9 * course.at_play)
          << "seed " << seed << ", " << steps_per_frame << " steps a frame";
      ++ran;
      if (steps_per_frame == 1) continue;
      const double w = scene.cables[0].half_width;
      squeezed += std::max(course.gap, course.overlap) > 1e-3 * w ? 1 : 0;
      stretched += course.stretch > 1e-3 * w ? 1 : 0;
    }
  }
  EXPECT_GT(ran, seeds_of(400));
  EXPECT_EQ(squeezed, 0) << "of " << ran;
  EXPECT_LE(stretched, 2) << "of " << ran;
}

TEST(RandomCorners, AClearedWorkspaceChangesNoBit) {
  int ran = 0;
  for (int seed = 0; seed < seeds_of(40); ++seed) {
    const Scene scene = falling_polygons(seed);
    try {
      EXPECT_TRUE(is_all_state(scene, Method::pinch, 240)) << seed;
    } catch (const SceneError&) {
      continue;
    }
    ++ran;
  }
  EXPECT_GE(ran, seeds_of(10));
}

}  // namespace
}  // namespace pinchlab::testing
