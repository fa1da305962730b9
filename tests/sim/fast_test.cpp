// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons that come further in a step than they, or what they meet, are thick.

#include <cmath>
#include <numbers>

#include "base/at.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "tests/sim/random.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double half_room = 1.0;  // m

void add_box(Scene& scene, const std::string& name, const Vec2& centre, const Vec2& half) {
  Body box = body(name, BodyKind::free, centre.x(), centre.y(), 0.0, 1.0);
  make_polygon(box, {-half, {half.x(), -half.y()}, half, {-half.x(), half.y()}}, 0.0);
  scene.bodies.push_back(box);
}

/// A closed room of walls, or of slabs that thick (m).
void add_room(Scene& scene, double thick) {
  const Vec2 corners[] = {{-half_room, -half_room},
                          {half_room, -half_room},
                          {half_room, half_room},
                          {-half_room, half_room}};
  for (int k = 0; k < 4; ++k) {
    const Vec2 &a = corners[k], &b = corners[(k + 1) % 4];
    if (thick == 0.0) {
      scene.walls.push_back({a, b, 0.3, 0.0});
      continue;
    }
    const double half = 0.5 * thick;
    const Vec2 centre = 0.5 * (a + b) + half * (a + b).normalized();
    const bool level = a.y() == b.y();
    add_box(scene, "slab " + std::to_string(k), centre,
            level ? Vec2(half_room + thick, half) : Vec2(half, half_room + thick));
    scene.bodies.back().kind = BodyKind::fixed;
  }
}

/// Bodies that fly and spin about in it.
Scene flying(unsigned seed) {
  Random random(seed);
  Scene scene;
  scene.gravity = Vec2::Zero();
  add_room(scene, seed % 2 == 0 ? 0.0 : random.uniform(0.01, 0.1));
  const int count = 1 + random.below(4);
  for (int i = 0; i < count; ++i) {
    const Vec2 centre(-0.6 + 0.4 * i, random.uniform(-0.5, 0.5));
    const std::string name = "body " + std::to_string(i);
    if (random.below(4) == 0) {
      scene.bodies.push_back(
          body(name, BodyKind::free, centre.x(), centre.y(), random.uniform(0.02, 0.15), 1.0));
    } else {
      add_box(scene, name, centre, {random.uniform(0.05, 0.18), random.uniform(0.005, 0.15)});
    }
    Body& flies = scene.bodies.back();
    const double speed = std::pow(10.0, random.uniform(0.5, 2.0));
    const double way = random.uniform(0.0, 2.0 * std::numbers::pi);
    flies.velocity = speed * Vec2(std::cos(way), std::sin(way));
    flies.angular_velocity = random.uniform(-40.0, 40.0);
    flies.restitution = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 1.0);
  }
  return scene;
}

// An outline is left behind, and is not in the way any more, where what comes upon it is clear of
// it again at a step's end; and a wall has no more than a line.
TEST(Fast, NothingLeavesAClosedRoom) {
  for (unsigned seed = 0; seed < seeds_of(200U); ++seed) {
    for (const int steps : {1, 4}) {
      Scene scene = flying(seed);
      scene.steps_per_frame = steps;
      World world = make_world(scene, Method::pinch);
      run(scene, world, 60 * steps);
      for (std::size_t b = 0; b < world.position.size(); ++b) {
        if (scene.bodies[b].kind == BodyKind::fixed) continue;
        EXPECT_LT(world.position[b].cwiseAbs().maxCoeff(), half_room)
            << "seed " << seed << ", " << steps << " steps a frame, " << scene.bodies[b].name;
      }
    }
  }
}

// 1 cm thick, it falls flat from 1 m on a wall, or on a slab.
TEST(Fast, APlankLiesOnWhatItFellOn) {
  for (const double thick : {0.0, 0.05}) {
    Scene scene;
    if (thick == 0.0) {
      scene.walls.push_back({{-1, 0}, {1, 0}, 0.5, 0.0});
    } else {
      add_box(scene, "slab", {0.0, -0.5 * thick}, {1.0, 0.5 * thick});
      scene.bodies.back().kind = BodyKind::fixed;
    }
    add_box(scene, "plank", {0.1, 1.0}, {0.2, 0.005});
    for (const int steps : {1, 2, 4, 16}) {
      const World world = after(scene, steps, 1.0);
      EXPECT_NEAR(world.position.back().y(), 0.005, 1e-12) << thick << ' ' << steps;
      EXPECT_NEAR(world.angle.back(), 0.0, 1e-12) << thick << ' ' << steps;
    }
  }
}

// A blade that a motor turns sweeps by a ball's place within a step: it hits it on its first turn,
// with the side that comes first, and throws it the way that this goes.
TEST(Fast, APaddleHitsWhatIsInItsWay) {
  constexpr double turning = 40.0, half_thick = 0.01, radius = 0.05, arm = 0.8;
  Scene scene;
  scene.gravity = Vec2::Zero();
  add_box(scene, "paddle", Vec2::Zero(), {1.0, half_thick});
  scene.bodies[0].kind = BodyKind::fixed_axle;
  scene.bodies[0].driven_angular_velocity = turning;
  scene.bodies.push_back(body("ball", BodyKind::free, 0.0, arm, radius, 1.0));
  // From level to upright it meets the ball's near side.
  const double hit = (0.5 * std::numbers::pi - std::asin((radius + half_thick) / arm)) / turning;
  for (const int steps : {1, 2, 4, 16}) {
    scene.steps_per_frame = steps;
    World world = make_world(scene, Method::pinch);
    run(scene, world, static_cast<int>(60.0 * steps * hit));
    EXPECT_EQ(world.velocity[1].norm(), 0.0) << steps;
    run(scene, world, 1);
    EXPECT_LT(world.velocity[1].x(), -10.0) << steps;
  }
}

// What none of its corners is beside when a step begins, as of a box that flies through the middle
// of an oblique wall.
TEST(Fast, ABoxMeetsAWallThatItComesUponObliquely) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.walls.push_back({{-0.25, -0.15}, {0.25, 0.15}, 0.5, 0.0});
  add_box(scene, "box", {-1.03, -0.05}, {0.06, 0.03});
  scene.bodies[0].velocity = {100.0, 0.0};
  const World exact = after(scene, 64, 0.1);
  EXPECT_GT(exact.velocity[0].y(), 10.0);
  for (const int steps : {1, 2, 4}) {
    const World world = after(scene, steps, 0.1);
    EXPECT_LT((world.position[0] - exact.position[0]).norm(), 1e-9) << steps;
    EXPECT_LT((world.velocity[0] - exact.velocity[0]).norm(), 1e-9) << steps;
  }
}

// By so much of the sum of their radii beside each other's centre.
TEST(Fast, DiscsThatGrazeEachOtherMeet) {
  constexpr double radius = 0.05;
  for (const bool wall : {false, true}) {
    for (const double beside : {0.3, 0.72, 0.8, 0.95}) {
      for (const double way : {-1.0, -0.9, -0.8, -0.7}) {  // m, to where it begins
        Scene scene;
        scene.gravity = Vec2::Zero();
        scene.bodies.push_back(body("flies", BodyKind::free, way, 2.0 * radius * beside, radius));
        scene.bodies[0].velocity = {35.0, 0.0};
        if (wall) {  // of which it meets the end
          scene.walls.push_back({{0.0, radius * beside}, {0.0, -1.0}, 0.5, 0.0});
        } else {
          scene.bodies.push_back(body("stands", BodyKind::fixed, 0.0, 0.0, radius));
        }
        const World exact = after(scene, 64, 0.1);
        EXPECT_GT(exact.velocity[0].y(), 0.1);
        for (const int steps : {1, 4}) {
          const World world = after(scene, steps, 0.1);
          EXPECT_LT((world.velocity[0] - exact.velocity[0]).norm(), 1e-8)
              << wall << ' ' << beside << ' ' << way << ' ' << steps;
        }
      }
    }
  }
}

// A rope of 2 m is hung up at both ends; what comes down on it at any place stays above it.
TEST(Fast, NothingPassesAHangingRope) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    Random random(seed);
    Scene scene;
    Cable rope = cable(at(-1.0, 0.0), {}, at(1.0, 0.0), 0.01);
    rope.mass_per_metre = 0.5;
    rope.slack = 0.02;
    rope.nodes = random.below(2) == 0 ? 3 : 15;
    scene.cables.push_back(rope);
    const double x = random.uniform(-0.5, 0.5);
    if (random.below(2) == 0) {
      scene.bodies.push_back(
          body("falls", BodyKind::free, x, 0.8, random.uniform(0.02, 0.06), 0.5));
    } else {
      add_box(scene, "falls", {x, 0.8}, {random.uniform(0.03, 0.08), random.uniform(0.01, 0.05)});
      scene.bodies[0].mass = 0.5;
      scene.bodies[0].angle = random.uniform(0.0, 3.0);
    }
    const double speed = random.uniform(10.0, 100.0);
    scene.bodies[0].velocity = {random.uniform(-0.3, 0.3) * speed, -speed};
    for (const int steps : {1, 4}) {
      Scene whole = scene;
      whole.steps_per_frame = steps;
      spread_nodes(whole);
      World world = make_world(whole, Method::pinch);
      run(whole, world, 2 * steps);
      // It is 0.8 m above, and the rope goes down by no more than 0.15 m.
      EXPECT_GT(world.position[0].y(), -0.25) << seed << ' ' << steps << ' ' << speed;
    }
  }
}

// A plank throws a box at a wall that this would not have reached in the step. It spins before as
// it does after, so that its corners are hardly faster, but it is.
TEST(Fast, WhatIsThrownWithinAStepMeetsAWall) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.frames_per_second = 30;
  scene.walls.push_back({{-1, -50}, {-1, 50}, 0.0, 1.0});
  add_box(scene, "box", {-0.6546087980256868, -0.34877867441761223},
          {0.042945819497377705, 0.0260135818489644});
  scene.bodies[0].angle = -29.580945454276875;
  scene.bodies[0].velocity = {-1.7039359586895557, 3.0055875831292873};
  scene.bodies[0].angular_velocity = -231.6609973236704;
  add_box(scene, "plank", {-0.5972866816410236, -0.36750248966407734},
          {0.09865801860369208, 0.006});
  scene.bodies[1].angle = 13.63222039213181;
  scene.bodies[1].velocity = {-8.115505031815736, -0.5236761289408305};
  scene.bodies[1].angular_velocity = 229.55926246984353;
  for (Body& one : scene.bodies) {
    one.restitution = 1.0;
    one.contact_friction = 0.0;
  }
  const World exact = after(scene, 64, 0.3);
  for (const int steps : {1, 2, 4}) {
    const World world = after(scene, steps, 0.3);
    EXPECT_LT((world.position[0] - exact.position[0]).norm(), 1e-6) << steps;
    EXPECT_GT(world.position[0].x(), -1.0) << steps;
  }
}

}  // namespace
}  // namespace pinchlab::testing
