// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies and walls do not overlap, by their places alone.

#include "tests/sim/overlap.h"
#include "sim/promises.h"
#include "sim/scene_error.h"
#include "sim/touch.h"

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

void expect_sound(Scene scene, double seconds, unsigned seed) {
  for (const int steps : {1, 4, 16}) {
    scene.steps_per_frame = steps;
    const Overlaps run = run_overlaps(scene, seconds);
    EXPECT_LE(run.largest, steps == 1 ? 1e-5 : 1e-6) << "seed " << seed << ", " << steps;
    EXPECT_LE(run.gained, 1e-9 * run.at_play) << "seed " << seed << ", " << steps;
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

// The tip that slides into the nook is beyond the ends of both walls by round-off.
TEST(Overlap, ATipThatSlidesIntoANookStopsThere) {
  for (const double turn : {0.0, 0.1, 0.7, -0.4}) {
    for (const double lean : {0.0, 0.3, 1.2, -0.9}) {  // rad, of the wall that the floor meets
      for (const bool in_the_middle : {false, true}) {
        Scene scene;
        scene.bodies = {triangle("slides", 0.8)};
        scene.bodies[0].velocity = {-2.0, 0.0};
        scene.bodies[0].contact_friction = 0.0;
        const Vec2 up = turned({0.0, 1.0}, lean);
        scene.walls.push_back({{3.0, 0.0}, {0.0, 0.0}, 0.0, 0.0});
        scene.walls.push_back(
            {in_the_middle ? Vec2(-1.0 * up) : Vec2(0.0, 0.0), 1.1 * up, 0.0, 0.0});
        for (Body& b : scene.bodies) {
          b.position = turned(b.position, turn);
          b.velocity = turned(b.velocity, turn);
          b.angle = turn;
        }
        for (Wall& wall : scene.walls) {
          wall.a = turned(wall.a, turn) + Vec2(0.1, 0.7);
          wall.b = turned(wall.b, turn) + Vec2(0.1, 0.7);
        }
        scene.bodies[0].position += Vec2(0.1, 0.7);
        expect_no_overlap(scene, 1.0, fmt::format("{} {} {}", turn, lean, in_the_middle).c_str());
      }
    }
  }
}

// A box whose corner stands where two walls of a straight floor meet.
TEST(Overlap, ACornerOnTheSeamOfAFloorStandsThere) {
  for (const double turn : {0.0, 0.1, 0.3, -0.25}) {
    Scene scene;
    scene.bodies = {polygon("box", BodyKind::free, {0.2, 0.1},
                            {{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}})};
    scene.bodies[0].contact_friction = 2.0;
    scene.walls.push_back({{-1.0, 0.0}, {0.0, 0.0}, 2.0, 0.0});
    scene.walls.push_back({{1.3, 0.0}, {0.0, 0.0}, 2.0, 0.0});
    scene.bodies[0].position = turned(scene.bodies[0].position, turn);
    scene.bodies[0].angle = turn;
    for (Wall& wall : scene.walls) {
      wall.a = turned(wall.a, turn);
      wall.b = turned(wall.b, turn);
    }
    expect_no_overlap(scene, 1.0, fmt::format("{}", turn).c_str());
  }
}

// A corner that hangs over a low wall, behind it, is free to move down there.
TEST(Overlap, WhatHangsOverAStubIsNotHeldByTheFloorBeyond) {
  Scene scene;
  scene.bodies = {
      polygon("hangs", BodyKind::free, {0.0, 0.5}, {{0.3, -0.6}, {0.4, 0.5}, {-0.7, 0.1}})};
  scene.walls.push_back({{-2.0, 0.0}, {0.1, 0.0}, 0.5, 0.0});
  scene.walls.push_back({{0.1, 0.0}, {0.1, 0.03}, 0.5, 0.0});
  const World world = make_world(scene, Method::pinch);
  for (const Contact& contact : world.contacts) EXPECT_GT(contact.gap, 0.0);
}

// A bar that leans on the end of a shelf, one of its corners below it.
TEST(Overlap, WhatReachesRoundTheEndOfAWallIsOnBothItsSides) {
  Scene scene;
  scene.bodies = {polygon("leans", BodyKind::free, {0.303, 0.1},
                          {{-0.45, -0.35}, {-0.35, -0.45}, {0.45, 0.35}, {0.35, 0.45}})};
  scene.walls.push_back({{-2.0, 0.0}, {0.1, 0.0}, 0.5, 0.0});
  const World world = make_world(scene, Method::pinch);
  ASSERT_GE(world.contacts.size(), 1U);
  for (const Contact& contact : world.contacts) EXPECT_GE(contact.gap, 0.0);
  expect_no_overlap(scene, 0.3, "leans");
}

Body square(const char* name, BodyKind kind, double x, double half) {
  return polygon(name, kind, {x, 0.0},
                 {{-half, -half}, {half, -half}, {half, half}, {-half, half}});
}

TEST(Overlap, SquaresOnAxlesStopAtWallsAndAtEachOther) {
  Scene wall;
  wall.bodies = {square("turns", BodyKind::fixed_axle, 0.0, 0.5)};
  wall.bodies[0].angular_velocity = 1.0;
  Scene still = wall, gear = wall;
  wall.walls.push_back({{-1.0, -0.55}, {1.0, -0.55}, 0.5, 0.0});
  still.bodies.push_back(square("still", BodyKind::fixed, 1.1, 0.5));
  gear.bodies.push_back(square("gear", BodyKind::fixed_axle, 1.1, 0.5));
  Scene driven = wall;
  driven.bodies[0].driven_angular_velocity = 1.0;
  driven.bodies[0].torque_limit = 3.0;
  Scene compound = wall;
  std::vector<Shape> shapes(2);
  make_polygon(shapes[0].properties, {{-0.1, -0.5}, {0.1, -0.5}, {0.1, 0.5}, {-0.1, 0.5}}, 0.0);
  shapes[1] = shapes[0];
  shapes[1].angle = 1.57;
  compound.bodies[0].corners.clear();
  add_shapes(compound, 0, shapes);
  for (const auto& [what, scene] : {std::pair("wall", wall),
                                    {"still", still},
                                    {"gear", gear},
                                    {"driven", driven},
                                    {"compound", compound}}) {
    expect_no_overlap(scene, 3.0, what);
  }
}

// What lies on a square's side, under a fixed box, keeps its width.
TEST(Overlap, ADrivenSquareDoesNotSqueezeItsCableIntoABox) {
  for (const int steps : {4, 16}) {
    Scene scene;
    scene.steps_per_frame = steps;
    scene.bodies = {square("turns", BodyKind::fixed_axle, 0.0, 0.3),
                    square("box", BodyKind::fixed, 0.0, 0.3),
                    body("left", BodyKind::free, -0.35, -2.0, 0.1, 2.0),
                    body("right", BodyKind::free, 0.35, -2.0, 0.1, 2.0)};
    scene.bodies[1].position = {0.0, 0.75};
    scene.bodies[0].mass = 5.0;
    scene.bodies[0].driven_angular_velocity = -1.5;
    scene.bodies[0].torque_limit = 300.0;
    scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(3), 0.03));
    World world = make_world(scene, measured());
    Workspace work;
    for (int i = 0; i < 60 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      const double gap = -overlap_of(hull_of(world, 0), hull_of(world, 1));
      ASSERT_GE(gap, 0.06 - 1e-6) << steps << ", " << i;
    }
  }
}

Scene gears(unsigned seed) {
  Random random(2000 + seed);
  Scene scene;
  const int count = 2 + random.below(3);
  for (int i = 0; i < count; ++i) {
    const BodyKind kind = i > 0 && random.below(4) == 0 ? BodyKind::fixed : BodyKind::fixed_axle;
    Body b = body(fmt::format("gear {}", i), kind, 0.9 * i, random.uniform(-0.2, 0.2), 1.0, 1.0);
    make_random_polygon(random, 0.5, random.below(2) == 0, b);
    b.angular_velocity = random.uniform(-5.0, 5.0);
    b.contact_friction = random.uniform(0.0, 1.0);
    b.restitution = random.below(2) == 0 ? 0.5 : 0.0;
    b.angle = random.uniform(0.0, 6.0);
    scene.bodies.push_back(b);
  }
  scene.walls.push_back({{-2.0, random.uniform(-0.9, -0.45)}, {4.0, -0.6}, 0.5, 0.0});
  return scene;
}

TEST(RandomOverlap, PolygonsOnAxlesTurnIntoNothing) {
  int ran = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Scene scene = gears(seed);
    try {
      make_world(scene, Method::pinch);
    } catch (const SceneError&) {
      continue;  // they overlap at the start
    }
    expect_sound(scene, 1.0, seed);
    ++ran;
  }
  EXPECT_GT(ran, 20);
}

// In front of neither side by its radius, and yet clear: what is round meets a corner diagonally.
TEST(Overlap, ADiscBesideACornerIsClearOfIt) {
  Scene scene;
  scene.bodies = {square("box", BodyKind::fixed, 0.0, 0.3),
                  body("disc", BodyKind::free, 0.375, 0.375, 0.1)};
  const double apart = std::hypot(0.075, 0.075);
  const World world = make_world(scene, Method::pinch);
  EXPECT_NEAR(separation(world, 0, 1), apart - 0.1, 1e-15);
  EXPECT_NEAR(separation(world, 1, 0), apart - 0.1, 1e-15);

  scene.bodies[1] = square("other", BodyKind::free, 0.0, 0.1);
  scene.bodies[1].position = {0.475, 0.475};
  EXPECT_NEAR(separation(make_world(scene, Method::pinch), 0, 1), apart, 1e-15);
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

TEST(RandomOverlap, SharpPolygonsPileUpOnAFloor) {
  for (unsigned seed = 0; seed < seeds_of(16U); ++seed) {
    Scene scene = pile(seed);
    scene.walls.push_back({{-1.5, 0.0}, {1.5, 0.0}, 0.5, 0.0});
    scene.walls.push_back({{-1.0, -0.5}, {-1.0, 6.0}, 0.5, 0.0});
    scene.walls.push_back({{1.0, -0.5}, {1.0, 6.0}, 0.5, 0.0});
    expect_sound(scene, 1.5, seed);
  }
}

// A trough of random slopes, whose walls meet at their ends; at times one ends on another's middle.
Scene trough(unsigned seed) {
  Scene scene = pile(seed);
  Random random(1000 + seed);
  const int pieces = 1 + random.below(4);
  std::vector<Vec2> corners{{-0.9 - random.uniform(0.0, 0.5), 6.0}};
  for (int i = 0; i <= pieces; ++i) {
    const double x = -0.6 + 1.2 * i / pieces + 0.1 * random.uniform(-1.0, 1.0);
    corners.emplace_back(x, random.below(2) == 0 ? 0.0 : x * x * random.uniform(0.0, 0.5));
  }
  corners.emplace_back(0.9 + random.uniform(0.0, 0.5), 6.0);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    Wall wall{corners[i - 1], corners[i], 0.5, 0.0};
    if (random.below(2) == 0) std::swap(wall.a, wall.b);
    scene.walls.push_back(wall);
  }
  const Vec2 &p = corners[0], &q = corners[1];
  const Vec2 middle = p + random.uniform(0.7, 0.95) * (q - p);
  if (random.below(2) == 0) scene.walls.push_back({middle, middle + Vec2(0.3, 0.1), 0.5, 0.0});
  return scene;
}

TEST(RandomOverlap, SharpPolygonsPileUpInATroughWhoseWallsMeet) {
  for (unsigned seed = 8; seed < 8 + seeds_of(16U); ++seed) expect_sound(trough(seed), 1.5, seed);
}

}  // namespace
}  // namespace pinchlab::testing
