// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies and walls do not overlap, by their places alone.

#include "tests/sim/overlap.h"
#include "sim/promises.h"

namespace pinchlab::testing {
namespace {

Body polygon(const char* name, BodyKind kind, const Vec2& position, std::vector<Vec2> corners) {
  Body b = body(name, kind, position.x(), position.y(), 1.0, 1.0);
  make_polygon(b, std::move(corners), 0.0);
  b.contact_friction = 0.1;
  return b;
}

Body triangle(const char* name, double x) {
  return polygon(name, BodyKind::free, {x, 0.1}, {{-0.2, -0.1}, {0.2, -0.1}, {0.0, 0.2}});
}

void expect_no_overlap(Scene scene, double seconds, const char* what) {
  for (const int steps : {1, 4, 16}) {
    scene.steps_per_frame = steps;
    const Overlaps run = run_overlaps(scene, seconds);
    EXPECT_LE(run.largest, 1e-9) << what << ", " << steps;
  }
}

Scene two_triangles(double lift) {
  Scene scene;
  scene.bodies = {triangle("still", 0.0), triangle("slides", 0.8)};
  scene.bodies[1].velocity = {-2.0, 0.0};
  scene.bodies[1].position.y() += lift;
  scene.gravity = Vec2::Zero();
  return scene;
}

// The tip of one lies on the line of the other's underside.
TEST(Overlap, TriangleTipsThatMeetOnAFloorStop) {
  Scene scene = two_triangles(0.0);
  scene.gravity = {0.0, -g};
  scene.walls.push_back({{-3.0, 0.0}, {3.0, 0.0}, 0.1, 0.0});
  expect_no_overlap(scene, 1.0, "on a floor");
}

TEST(Overlap, TriangleTipsThatMeetAtTheSameHeightStop) {
  for (const double lift : {0.0, 1e-16, 1e-12, 1e-11, 1e-10, 1e-9, 1e-6, -1e-12, -1e-10, -1e-9}) {
    expect_no_overlap(two_triangles(lift), 0.7, fmt::format("{}", lift).c_str());
  }
}

// Tips that lean over each other: neither is ever within the other.
TEST(Overlap, TipsThatLeanOverEachOtherStop) {
  Scene scene = two_triangles(0.0);
  for (int i : {0, 1}) {
    Body& b = scene.bodies[static_cast<std::size_t>(i)];
    b.angle = i == 0 ? -0.3 : 0.3;
    const Vec2 tip = turned({i == 0 ? 0.2 : -0.2, -0.1}, b.angle);
    b.position = Vec2(i == 0 ? 0.0 : 0.4, 0.0) - tip;
  }
  expect_no_overlap(scene, 0.7, "leaning");
}

TEST(Overlap, ACrateStopsAtARampOnItsFloor) {
  Scene scene;
  const double third = 1.0 / 6.0;
  scene.bodies.push_back(polygon("ramp", BodyKind::fixed, {0.0, 0.2},
                                 {{-4.0 * third, -0.2}, {5.0 * third, -0.2}, {-third, 0.4}}));
  scene.bodies.push_back(polygon("crate", BodyKind::free, {2.0, 0.15},
                                 {{-0.2, -0.15}, {0.2, -0.15}, {0.2, 0.15}, {-0.2, 0.15}}));
  scene.bodies[1].velocity = {-4.0, 0.0};
  scene.walls.push_back({{-3.0, 0.0}, {5.0, 0.0}, 0.5, 0.0});
  expect_no_overlap(scene, 1.5, "ramp");
}

// What contacts do not see, watchers do.
TEST(Overlap, APromiseOfGapsIsOneOfOutlines) {
  Scene scene = two_triangles(0.0);
  scene.bodies[1].position.x() = 0.41;
  World world = make_world(scene, Method::pinch);
  Promises promises(scene, world);
  world.position[1].x() = 0.3;
  ASSERT_FALSE(world.contacts.empty());
  for (Contact& contact : world.contacts) contact.gap = 0.0;
  promises.note(scene, world);
  ASSERT_EQ(promises.broken(scene, world).size(), 1U);
}

Scene pile(unsigned seed) {
  Random random(seed);
  Scene scene;
  const int count = 4 + random.below(5);
  for (int i = 0; i < count; ++i) {
    Body b = body(fmt::format("p{}", i), BodyKind::free, random.uniform(-0.3, 0.3), 0.3 + 0.45 * i,
                  1.0, std::pow(10.0, random.uniform(-0.5, 0.7)));
    make_random_polygon(random, random.uniform(0.12, 0.2), true, b);
    b.restitution = random.below(2) == 0 ? 0.3 : 0.0;
    scene.bodies.push_back(b);
  }
  return scene;
}

void expect_sound(Scene scene, double seconds, unsigned seed) {
  for (const int steps : {1, 4, 16}) {
    scene.steps_per_frame = steps;
    const Overlaps run = run_overlaps(scene, seconds);
    EXPECT_LE(run.largest, steps == 1 ? 1e-5 : 1e-6) << "seed " << seed << ", " << steps;
    EXPECT_LE(run.gained, 1e-9 * run.at_play) << "seed " << seed << ", " << steps;
  }
}

TEST(RandomOverlap, SharpPolygonsPileUpOnAFloor) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    Scene scene = pile(seed);
    scene.walls.push_back({{-1.5, 0.0}, {1.5, 0.0}, 0.5, 0.0});
    scene.walls.push_back({{-1.0, -0.5}, {-1.0, 6.0}, 0.5, 0.0});
    scene.walls.push_back({{1.0, -0.5}, {1.0, 6.0}, 0.5, 0.0});
    expect_sound(scene, 1.5, seed);
  }
}

}  // namespace
}  // namespace pinchlab::testing
