// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons that slide over joints: of walls, and of blocks in a row.

#include <cmath>

#include "sim/outline.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

Body box(const char* name, BodyKind kind, double x, double y, double half_width, double half_height,
         double friction) {
  Body body = build::body(name, kind, x, y, 0.1, 1.0);
  make_polygon(body,
               {{-half_width, -half_height},
                {half_width, -half_height},
                {half_width, half_height},
                {-half_width, half_height}},
               0.0);
  body.contact_friction = friction;
  return body;
}

enum class Floor { walls, walls_backwards, blocks };

/// From -3 m to 3 m at height 0, joined at 0 and 1 m.
void add_floor(Scene& scene, Floor floor, double friction) {
  const double joints[] = {-3.0, 0.0, 1.0, 3.0};
  for (int i = 0; i < 3; ++i) {
    const double from = joints[i], to = joints[i + 1];
    if (floor == Floor::blocks) {
      scene.bodies.push_back(
          box("block", BodyKind::fixed, 0.5 * (from + to), -0.2, 0.5 * (to - from), 0.2, friction));
    } else if (floor == Floor::walls) {
      scene.walls.push_back({Vec2(from, 0.0), Vec2(to, 0.0), friction, 0.0});
    } else {
      scene.walls.insert(scene.walls.begin(), {Vec2(to, 0.0), Vec2(from, 0.0), friction, 0.0});
    }
  }
}

class OverJoints : public ::testing::TestWithParam<std::tuple<Floor, int, double>> {};

// The end of what goes on stopped its leading side: 2 m/s became 0.3, and faster ones fell over.
TEST_P(OverJoints, ABoxSlidesOn) {
  const auto [floor, steps, speed] = GetParam();
  for (const double start : {-1.0, -0.73, -0.2 - 0.1 * speed}) {
    Scene scene;
    scene.bodies.push_back(box("box", BodyKind::free, start, 0.1, 0.2, 0.1, 0.0));
    scene.bodies[0].velocity.x() = speed;
    if (speed < 0.0) scene.bodies[0].position.x() = -start;
    add_floor(scene, floor, 0.0);
    scene.steps_per_frame = steps;
    World world = make_world(scene, measured());
    run(scene, world, 30 * steps);
    EXPECT_NEAR(world.position[0].x(), scene.bodies[0].position.x() + 0.5 * speed, 1e-9) << start;
    EXPECT_NEAR(world.position[0].y(), 0.1, 1e-11) << start;
    EXPECT_NEAR(world.angle[0], 0.0, 1e-9) << start;
    EXPECT_EQ(world.diagnostics.fallbacks, 0) << start;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Tips, OverJoints,
    ::testing::Combine(::testing::Values(Floor::walls, Floor::walls_backwards, Floor::blocks),
                       ::testing::Values(1, 4, 16), ::testing::Values(2.0, 3.7, -2.0)));

// With friction it comes to rest where it would on one wall.
TEST(Tips, ABoxComesToRestBeyondAJoint) {
  for (const Floor floor : {Floor::walls, Floor::blocks}) {
    Scene scene;
    scene.bodies.push_back(box("box", BodyKind::free, -0.5, 0.1, 0.2, 0.1, 0.3));
    scene.bodies[0].velocity.x() = 2.0;
    add_floor(scene, floor, 0.3);
    World world = make_world(scene, measured());
    run(scene, world, 240);
    EXPECT_NEAR(world.position[0].x(), -0.5 + 4.0 / (2.0 * 0.3 * g), 1e-9);
    EXPECT_NEAR(world.angle[0], 0.0, 1e-9);
  }
}

// Boxes on one floor do meet, by corners that are in line with each other's undersides.
TEST(Tips, BoxesOnOneFloorMeet) {
  Scene scene;
  scene.bodies.push_back(box("box", BodyKind::free, -0.5, 0.1, 0.2, 0.1, 0.0));
  scene.bodies.push_back(box("other", BodyKind::free, 0.5, 0.1, 0.2, 0.1, 0.0));
  scene.bodies[0].velocity.x() = 2.0;
  add_floor(scene, Floor::walls, 0.0);
  World world = make_world(scene, measured());
  run(scene, world, 240);
  // 0.6 m apart they meet after 0.3 s, and go on together at 1 m/s.
  EXPECT_NEAR(world.position[0].x(), -0.5 + 0.6 + 0.7, 1e-9);
  EXPECT_NEAR(world.position[1].x(), 0.5 + 0.7, 1e-9);
}

}  // namespace
}  // namespace pinchlab::testing
